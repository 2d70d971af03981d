"""Dropout sampling and uncertainty measures."""
