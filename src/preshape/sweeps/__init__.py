"""Folders and tables of sweeps, of trainings as of evaluations."""
