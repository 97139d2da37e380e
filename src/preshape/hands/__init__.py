"""Differentiable forward kinematics of hands: theta to palm and fingers in the camera frame."""
