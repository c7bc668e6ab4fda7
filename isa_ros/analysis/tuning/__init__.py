"""Gains of a loop for a wanted phase margin and bandwidth over the stroke."""
