"""Contact that pushes and never pulls."""

import math

from isa_ros.core.kernel import kernel


@kernel
def one_sided(depth, rate, stiffness, damping):
    """
    Return max(0, k d + c d') while touching, else 0  (M3), in N or Nm.

    ``depth`` is positive inside the contact, ``rate`` its time derivative.
    """
    if depth <= 0.0:
        return 0.0
    return max(0.0, stiffness * depth + damping * rate)


@kernel
def normal_force(height, v_z, law):
    """
    Return N = max(0, k d^1.5 (1 + c d'))  (L9), in N; d = -height, d' = -v_z.

    d^1.5 is computed as d sqrt(d): continuous with its first derivative at touchdown.
    """
    if height >= 0.0:
        return 0.0
    depth = -height
    return max(0.0, law.stiffness * depth * math.sqrt(depth) * (1.0 - law.damping * v_z))
