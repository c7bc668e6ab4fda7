"""Constants of nature: one home for all modules."""

ATMOSPHERE = 101325.0  # Pa, ISO 2533: between gauge and absolute pressures
STANDARD_GRAVITY = 9.80665  # m/s2, for legs and for weights
