"""Frames, the sources that yield them, and everything that is read."""
