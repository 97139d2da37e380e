"""Scenes, trials, their tables, folds and the data module."""
