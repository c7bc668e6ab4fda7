"""Simulate a bag again from itself, and compare bags."""
