"""Lens models: projection of a direction, and its inverse; one file a model, found by a registry."""
