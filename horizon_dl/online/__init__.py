"""A run over a stream: guard, pace, run directory, logs, periodic export."""
