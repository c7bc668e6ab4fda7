"""Signals of a bag, and what can be read from them."""
