"""Measurements on finished runs and on the code itself."""
