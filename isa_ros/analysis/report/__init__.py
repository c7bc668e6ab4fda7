"""Figures of a run, and figures of the paper drawn from a bag."""
