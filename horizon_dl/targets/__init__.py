"""What the learners are trained on."""
