"""Cameras, films and streams as they come."""
