"""Everything the coordinator publishes at a tick, as prepared CDR bytes."""

from collections.abc import Sequence

from msg_adapters import clock, fluid_pressure, joint_state, wrench
from msg_adapters.template import STAMP, stamp, Template

WORLD_FRAME = 'world'


class ClockMessage:
    """Prepared ``/clock``."""

    def __init__(self) -> None:
        self._template = Template([clock.clock()], n_values=2)

    def pack(self, t_ns: int) -> bytes:
        """Return the CDR bytes of simulation time ``t_ns``."""
        return self._template.pack(stamp(t_ns))[0]


class SupplyPressureMessage:
    """Prepared ``~/supply_pressure``."""

    def __init__(self, frame_id: str = 'supply') -> None:
        self._template = Template([fluid_pressure.fluid_pressure(frame_id, 2)], n_values=3)

    def pack(self, gauge: float, t_ns: int) -> bytes:
        """Return the CDR bytes of a gauge pressure (Pa), published as absolute."""
        return self._template.pack((*stamp(t_ns), fluid_pressure.absolute(gauge)))[0]


class LegJointStateMessage:
    """Prepared ``joint_states`` of the leg: URDF joints in fixed order."""

    def __init__(self, joints: Sequence[str], frame_id: str = WORLD_FRAME) -> None:
        n = len(joints)
        fields = joint_state.entries(
            n, position=range(2, 2 + n), velocity=range(2 + n, 2 + 2 * n),
            effort=range(2 + 2 * n, 2 + 3 * n))
        self._template = Template(
            [(joint_state.joint_state(frame_id, joints), fields)], n_values=2 + 3 * n)

    def pack(
            self, positions: Sequence[float], velocities: Sequence[float],
            efforts: Sequence[float], t_ns: int) -> bytes:
        """Return the CDR bytes of q (rad | m), its speed and effort (Nm | N), each (n,)."""
        return self._template.pack((*stamp(t_ns), *positions, *velocities, *efforts))[0]


class GroundContactMessage:
    """Prepared ``~/ground_contact``: the ground's force on the foot."""

    def __init__(self, frame_id: str = WORLD_FRAME) -> None:
        axes = {f'wrench.force.{axis}': 2 + k for k, axis in enumerate('xyz')}
        self._template = Template([(wrench.wrench(frame_id), {**STAMP, **axes})], n_values=5)

    def pack(self, force: Sequence[float], t_ns: int) -> bytes:
        """Return the CDR bytes of a force (3,), N, at the foot; no torque is transmitted."""
        return self._template.pack((*stamp(t_ns), *force))[0]
