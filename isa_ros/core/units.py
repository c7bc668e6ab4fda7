"""Data-sheet units in SI, and units of linear and rotary actuators."""

LPM = 1e-3 / 60.0  # 1 l/min in m3/s
MPA = 1e6          # 1 MPa in Pa
MILLI = 1e-3       # 1 mm in m, 1 mA in A
MICRO = 1e-6       # 1 um in m, 1 uA in A
LITRE = 1e-3       # 1 l in m3
MILLILITRE = 1e-6  # 1 ml in m3


def of_coordinate(unit: str, is_rotary: bool) -> str:
    """Return the linear or the rotary alternative of a unit ``linear | rotary``."""
    linear, _, rotary = unit.partition(' | ')
    return rotary if rotary and is_rotary else linear
