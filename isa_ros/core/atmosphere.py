"""The standard atmosphere, between gauge and absolute pressures."""

ATMOSPHERE = 101325.0  # Pa, ISO 2533
