"""Public data sets: what there is, and fetching them from their official hosts."""
