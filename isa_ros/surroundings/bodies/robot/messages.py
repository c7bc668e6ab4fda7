"""Messages of a robot: its joints, its free root, the force on each foot, its inertial units."""

from collections.abc import Sequence

from isa_ros.surroundings.bodies.robot.sheet import RobotSheet, RobotUnit
from isa_ros.surroundings.inertial_unit import fields_of_unit
from isa_ros.surroundings.messages import (
    BodyMessage, columns, Force, Inertial, JOINT_STATES, JointStates, Odometry)

ODOM = 'odom'
GROUND_CONTACT = 'ground_contact'
"""Topics, after the prefix of a robot, and that of a foot."""


def robot_messages(
        prefix: str, sheet: RobotSheet, units: Sequence[tuple[RobotUnit, str]]
        ) -> tuple[BodyMessage, ...]:
    """
    Return the messages of a robot; ``prefix`` is '' for the only body of a run, else ``NAME/``.

    Frames are links of the URDF behind the prefix. ``units`` have the name of the link that each
    is on, whose axes are its own.
    """
    joints = [joint.name for joint in sheet.joints]
    position, velocity, torque = (
        [f'{joint}_{what}' for joint in joints] for what in ('position', 'velocity', 'torque'))
    found: list[BodyMessage] = [
        JointStates(f'/{prefix}{JOINT_STATES}', joints, position, velocity, torque)]
    if sheet.is_free:
        twist = columns('twist', 6)
        found.append(Odometry(
            f'/{prefix}{ODOM}', f'{prefix}{sheet.links[0].name}', columns('position'),
            columns('orientation', 4), twist[:3], twist[3:]))
    for contact in sheet.contacts:
        if contact.is_foot:
            wrench = columns(f'{contact.name}_wrench', 6)
            found.append(Force(
                f'/{prefix}{contact.name}/{GROUND_CONTACT}', wrench[:3], wrench[3:],
                frame=f'{prefix}{sheet.frame_of(contact).name}'))
    for unit, link in units:
        force, turning = fields_of_unit(unit.name)
        found.append(Inertial(
            f'/{prefix}{unit.name}/imu', f'{prefix}{link}',
            (unit.accelerometer_sigma, unit.gyro_sigma), columns(force), columns(turning),
            unit.period_ns))
    return tuple(found)
