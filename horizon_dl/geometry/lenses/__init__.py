"""Lens models: what a lens makes of a direction, and the way back; one file a model, found by a registry."""
