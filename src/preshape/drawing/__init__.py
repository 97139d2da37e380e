"""Pictures: grasps in the view, and the channels of the image."""
