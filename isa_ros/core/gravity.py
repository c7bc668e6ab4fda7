"""Standard gravity, used for legs and for weights."""

STANDARD_GRAVITY = 9.80665  # m/s2
