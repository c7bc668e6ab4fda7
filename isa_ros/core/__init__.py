"""Foundations of the other packages: kernels, parameters, units, time, signals, contact."""
