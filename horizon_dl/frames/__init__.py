"""Frames and the readers of recordings."""
