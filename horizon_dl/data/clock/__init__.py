"""Two clocks, that of the pictures and that of the log: how far they are apart, found from what both saw turn."""
