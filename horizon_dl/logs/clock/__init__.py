"""The clocks of pictures and log: how far they are apart, found from what both saw turn."""
