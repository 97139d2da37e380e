"""Robots: an arm with a hand as one URDF, and what the simulator and the planners need to know about it."""
