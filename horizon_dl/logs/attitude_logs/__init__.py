"""Logs of an attitude, one file a kind, found by a registry."""
