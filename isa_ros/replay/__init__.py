"""Simulate the run of a bag again, and compare bags."""
