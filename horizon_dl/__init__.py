"""Obstacles from the uncertainty about what lies above and below the horizon."""

__version__ = "0.1.0"
