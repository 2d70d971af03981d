"""The simulated arena: procedural scene, flight, renderer, and the embedded data set."""
