"""What the two-finger networks and planners do in images."""
