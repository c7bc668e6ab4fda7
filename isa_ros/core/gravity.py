"""The one gravity of legs and weights."""

STANDARD_GRAVITY = 9.80665  # m/s2
