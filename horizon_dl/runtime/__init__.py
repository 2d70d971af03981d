"""What flies: the model file, perception, the flight loop and its watchdog; needs no torch."""
