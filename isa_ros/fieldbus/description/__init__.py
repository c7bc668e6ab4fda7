"""Descriptions of devices, from the one table of objects."""
