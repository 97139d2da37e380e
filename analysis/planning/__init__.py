"""What planners' grasps came to when they were executed."""
