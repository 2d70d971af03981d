"""What is written for others to read, as checked models with a version."""
