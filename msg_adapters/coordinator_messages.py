"""Everything the coordinator publishes at a tick, as prepared CDR bytes."""

from collections.abc import Sequence

from msg_adapters import clock, fluid_pressure, joint_state, wrench
from msg_adapters.template import STAMP, Template
import numpy as np

SUPPLY_FRAME = 'supply'
WORLD_FRAME = 'world'


class ClockMessage:
    """Prepared ``/clock``."""

    def __init__(self) -> None:
        self._template = Template([clock.clock()], n_values=0)

    def pack(self, t_ns: int) -> bytes:
        """Return the CDR bytes of simulation time ``t_ns``."""
        return self._template.pack(t_ns)[0]


class SupplyMessages:
    """Prepared ``~/supply_pressure``, alone."""

    def __init__(self) -> None:
        self._template = Template([fluid_pressure.fluid_pressure(SUPPLY_FRAME, 0)], n_values=1)

    def pack(self, supply_pressure: float, t_ns: int) -> list[bytes]:
        """Return the CDR bytes of a gauge pressure (Pa), published as absolute."""
        self._template.values[0] = fluid_pressure.absolute(supply_pressure)
        return self._template.pack(t_ns)


class LegMessages:
    """
    Prepared ``~/supply_pressure``, ``joint_states`` and ``~/ground_contact`` of a leg.

    Joints are those of the URDF, in fixed order.
    """

    def __init__(self, joints: Sequence[str]) -> None:
        n = len(joints)
        fields = joint_state.entries(
            n, position=range(1, 1 + n), velocity=range(1 + n, 1 + 2 * n),
            effort=range(1 + 2 * n, 1 + 3 * n))
        axes = {f'wrench.force.{axis}': 1 + 3 * n + k for k, axis in enumerate('xyz')}
        self._template = Template([
            fluid_pressure.fluid_pressure(SUPPLY_FRAME, 0),
            (joint_state.joint_state(WORLD_FRAME, joints), fields),
            (wrench.wrench(WORLD_FRAME), {**STAMP, **axes})], n_values=4 + 3 * n)

    def pack(self, supply_pressure: float, leg: np.ndarray, t_ns: int) -> list[bytes]:
        """
        Return the CDR bytes of a gauge pressure (Pa), published as absolute, and of a leg.

        ``leg`` is q (rad | m), its speed and effort (Nm | N) of all joints, then the ground's
        force on the foot (N, no torque is transmitted), shape (3 n + 3,).
        """
        values = self._template.values
        values[0] = fluid_pressure.absolute(supply_pressure)
        values[1:] = leg
        return self._template.pack(t_ns)
