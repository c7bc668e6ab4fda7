"""Messages of a leg: its joints and the slider, the ground's force, its inertial units."""

from collections.abc import Sequence

from isa_ros.surroundings.bodies.leg.leg import InertialUnit
from isa_ros.surroundings.bodies.leg.sheet import JOINTS
from isa_ros.surroundings.inertial_unit import fields_of_unit
from isa_ros.surroundings.messages import (
    BodyMessage, columns, Force, Inertial, JOINT_STATES, JointStates)

SLIDER = 'slider'


def joint_name(name: str) -> str:
    """Return the name of a joint in the URDF; an actuator may have the same short name."""
    return f'{name}_joint'


def imu_frame(prefix: str, unit: str) -> str:
    """Return the frame of an inertial unit, a link of its own in the URDF."""
    return f'{prefix}{unit}_imu'


def leg_messages(prefix: str, units: Sequence[InertialUnit]) -> tuple[BodyMessage, ...]:
    """
    Return the messages of a leg; ``prefix`` is '' for the only body of a run, else ``NAME/``.

    The joints are all those of the URDF that are not fixed; the slider has no drive.
    """
    return (
        JointStates(
            f'/{prefix}{JOINT_STATES}', [joint_name(joint) for joint in (*JOINTS, SLIDER)],
            [*columns('position'), 'height'], [*columns('velocity'), 'height_velocity'],
            columns('torque')),
        Force(f'/{prefix or "coordinator/"}ground_contact', columns('foot_force'),
              columns('foot_moment')),
        *(_inertial(prefix, unit) for unit in units))


def _inertial(prefix: str, unit: InertialUnit) -> Inertial:
    force, turning = fields_of_unit(unit.name)
    return Inertial(
        f'/{prefix}{unit.name}/imu', imu_frame(prefix, unit.name),
        (unit.sheet.accelerometer_sigma, unit.sheet.gyro_sigma), columns(force),
        columns(turning), unit.period_ns)
