"""Identification of an actuator's parameters from its recorded sensor signals."""
