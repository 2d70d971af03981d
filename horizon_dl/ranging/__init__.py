"""Free distances over bearings: ground contact, filter in time, heading."""
