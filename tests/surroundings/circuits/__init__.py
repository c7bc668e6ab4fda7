"""Tests of the parts of a circuit and of circuits as a whole."""
