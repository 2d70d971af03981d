"""Public sets, fetched from their official hosts and checked by hash."""
