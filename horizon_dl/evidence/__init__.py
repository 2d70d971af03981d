"""Evidence that free space was seen: what a sector needs before it may be called free. numpy alone."""
