"""Robots from a URDF: the reader, and the tree made of it."""
