"""Runs: their files, and what these are resolved to."""
