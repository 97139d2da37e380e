"""What the generated objects look like; nothing here changes how they move."""
