"""Training, offline and online."""
