"""What a table of trials holds."""
