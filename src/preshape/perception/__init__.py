"""From an RGB-D view to the object, its surface and the 8-channel image."""
