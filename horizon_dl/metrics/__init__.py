"""What is measured against truth; each metric updates, merges and computes."""
