"""Runs from Python: load, change, simulate and sweep in memory; a bag on demand."""
