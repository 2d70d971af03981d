"""From a score map to obstacles."""
