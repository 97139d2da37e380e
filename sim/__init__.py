"""The simulated laboratory: robots, objects, camera and trials in SAPIEN."""
