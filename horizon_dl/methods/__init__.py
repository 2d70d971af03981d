"""Net, forest, model file and training-free baselines behind one interface."""
