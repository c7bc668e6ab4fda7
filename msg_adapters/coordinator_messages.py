"""Prepared messages of the coordinator at a tick: those of the body."""

from collections.abc import Mapping, Sequence

from msg_adapters import joint_state, wrench
from msg_adapters.template import Prepared, STAMP

WORLD_FRAME = 'world'
JOINT_TOPIC = ('/joint_states', joint_state.TYPE)
CONTACT_TOPIC = ('/coordinator/ground_contact', wrench.TYPE)


def leg(joints: Sequence[str], columns: Mapping[str, int]) -> dict[tuple[str, str], Prepared]:
    """
    Return joint states and ground contact of a leg by (topic, type).

    ``columns`` are those of its sample: ``position[k]`` (rad | m), ``velocity[k]`` and
    ``torque[k]`` (Nm | N) of the ``joints`` of the URDF, ``foot_force[k]`` from the ground (N).
    """
    n = len(joints)
    fields = joint_state.entries(
        n, position=_of('position', columns, n), velocity=_of('velocity', columns, n),
        effort=_of('torque', columns, n))
    axes = {f'wrench.force.{axis}': columns[f'foot_force[{k}]'] for k, axis in enumerate('xyz')}
    return {
        JOINT_TOPIC: (joint_state.joint_state(WORLD_FRAME, joints), fields),
        CONTACT_TOPIC: (wrench.wrench(WORLD_FRAME), {**STAMP, **axes})}


def _of(field: str, columns: Mapping[str, int], n: int) -> list[int]:
    return [columns[f'{field}[{k}]'] for k in range(n)]
