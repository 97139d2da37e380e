"""The Cornell grasp data set: images of objects with grasp rectangles for a two-finger gripper."""
