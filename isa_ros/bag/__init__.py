"""Bags: written, read, replayed and compared."""
