"""Frequency and step response of the loops of an actuator."""
