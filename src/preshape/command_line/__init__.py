"""What all commands have in common: how they start, read their settings, are interrupted, and end."""
