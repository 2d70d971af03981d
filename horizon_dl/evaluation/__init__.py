"""Protocols, scores and comparison."""
