"""The net, the forest and its features."""
