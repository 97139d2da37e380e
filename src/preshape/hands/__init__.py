"""Differentiable forward kinematics of hands: theta to palm, fingertips and pixels."""
