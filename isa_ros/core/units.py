"""Data-sheet units in SI."""

LPM = 1e-3 / 60.0  # 1 l/min in m3/s
MPA = 1e6          # 1 MPa in Pa
ATMOSPHERE = 101_325.0  # Pa, the zero of gauge pressures
MILLI = 1e-3       # 1 mm in m, 1 mA in A
MICRO = 1e-6       # 1 um in m, 1 uA in A
MILLILITRE = 1e-6  # 1 ml in m3
