"""Object sets: what stands on the table."""
