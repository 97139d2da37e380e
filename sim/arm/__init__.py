"""Motions of the arm: inverse kinematics, collision checks, paths and their timing."""
