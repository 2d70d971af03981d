"""Simulated worlds: procedural scenes, flights, renderer, and the embedded data set."""
