"""Contact that pushes and never pulls."""

from isa_ros.kernel import kernel


@kernel
def one_sided(depth, rate, stiffness, damping):
    """
    Return max(0, k d + c d') while touching, else 0  (M3), in N or Nm.

    ``depth`` is positive inside the contact, ``rate`` its time derivative.
    """
    if depth <= 0.0:
        return 0.0
    return max(0.0, stiffness * depth + damping * rate)
