"""Tables as people have them: separators, decimal commas, names of columns, units."""
