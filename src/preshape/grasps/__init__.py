"""The grasp space (what theta means) and the heuristic initial grasps."""
