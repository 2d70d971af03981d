"""Cameras, attitude and the horizon."""
