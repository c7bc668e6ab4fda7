"""The control loops of the Remote Electronics Unit, one loop a file."""
