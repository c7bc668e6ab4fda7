"""Gain scheduling over the stroke: a table at equal distances, straight lines between."""

import math

from isa_ros.kernel import kernel

POINTS = 21


@kernel
def scheduled(position, stroke, table):
    """Return the factor at ``position`` in [0, ``stroke``]; table shape (POINTS,)  (R6)."""
    place = max(0.0, min(1.0, position / stroke)) * (POINTS - 1)
    left = min(int(math.floor(place)), POINTS - 2)
    return table[left] + (place - left) * (table[left + 1] - table[left])
