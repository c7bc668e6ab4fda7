"""Signals of a bag, and quantities computed from them."""
