"""Keeping runs and trained networks where they can be compared and found again."""
