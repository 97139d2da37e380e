"""What trainings came to: cross validations, ablations, learning curves."""
