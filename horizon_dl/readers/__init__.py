"""Readers: one file a format, found through the registry."""
