"""Planners that climb the success probability within bounds."""
