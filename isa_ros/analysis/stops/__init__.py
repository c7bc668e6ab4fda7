"""Stops under load: situations, and what they need and cause."""
