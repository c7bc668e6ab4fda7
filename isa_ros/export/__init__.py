"""Actuators for programs without Python: a library of C, and an FMU."""
