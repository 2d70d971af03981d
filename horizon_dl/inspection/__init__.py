"""Whether a recording is fit to learn from, and why not."""
