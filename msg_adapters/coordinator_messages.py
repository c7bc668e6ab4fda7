"""Prepared messages of the coordinator at a tick: those of the body."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

from msg_adapters import applied_parameters, imu, joint_state, wrench
from msg_adapters.template import Prepared, STAMP

WORLD_FRAME = 'world'
JOINT_TOPIC = ('/joint_states', joint_state.TYPE)
CONTACT_TOPIC = ('/coordinator/ground_contact', wrench.TYPE)
SLIDER = 'slider'
APPLIED_PARAMETERS = ('/coordinator/applied_parameters', applied_parameters.TYPE)
"""Parameters of the supplies that took effect, named SUPPLY.KEY."""
NODE = 'coordinator'


class Unit(NamedTuple):
    """An inertial measurement unit of a body."""

    link: str
    sigmas: tuple[float, float]
    """Standard deviation of specific force (m/s2) and angular velocity (rad/s), 0: not known."""
    fields: tuple[str, str]
    """Both in the body's sample."""


def imu_topic(name: str) -> tuple[str, str]:
    """Return (topic, type) of an inertial unit."""
    return f'/{name}/imu', imu.TYPE


def joint_name(name: str) -> str:
    """Return the name of a joint in the URDF; an actuator may have the same short name."""
    return f'{name}_joint'


def leg(
        joints: Sequence[str], units: Mapping[str, Unit], columns: Mapping[str, int]
        ) -> dict[tuple[str, str], Prepared]:
    """
    Return joint states, ground contact and readings of the ``units`` of a leg by (topic, type).

    ``columns`` are those of its sample: ``position[k]`` (rad), ``velocity[k]`` and ``torque[k]``
    (Nm) of the ``joints``, ``height`` (m) and ``height_velocity`` of the slider, ``foot_force[k]``
    from the ground (N). The names are those of all joints of the URDF that are not fixed; the
    slider has no drive, so that its effort is 0.
    """
    n = len(joints)
    names = [*(joint_name(joint) for joint in joints), joint_name(SLIDER)]
    fields = joint_state.entries(
        n + 1, position=[*_of('position', columns, n), columns['height']],
        velocity=[*_of('velocity', columns, n), columns['height_velocity']],
        effort=_of('torque', columns, n))
    axes = {f'wrench.force.{axis}': columns[f'foot_force[{k}]'] for k, axis in enumerate('xyz')}
    return {
        JOINT_TOPIC: (joint_state.joint_state(WORLD_FRAME, names), fields),
        CONTACT_TOPIC: (wrench.wrench(WORLD_FRAME), {**STAMP, **axes}),
        **{imu_topic(name): imu.imu(unit.link, unit.sigmas, [
            column for field in unit.fields for column in _of(field, columns, 3)])
           for name, unit in units.items()}}


def _of(field: str, columns: Mapping[str, int], n: int) -> list[int]:
    return [columns[f'{field}[{k}]'] for k in range(n)]
