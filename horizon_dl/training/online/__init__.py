"""The online learner: a few steps a frame, replay from a compressed buffer."""
