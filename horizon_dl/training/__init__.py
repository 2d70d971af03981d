"""Offline training: crops, rounds, the frame store, run folders."""
