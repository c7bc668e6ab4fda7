"""Messages that a body declares: prepared for packing, and where a bag has its columns."""

from collections.abc import Iterator, Mapping, Sequence

from isa_ros.surroundings.messages import (
    BodyMessage, Force, Inertial, JointStates, Odometry)
from msg_adapters import joint_state, odometry
from msg_adapters.coordinator_messages import WORLD_FRAME
from msg_adapters.sensor_messages import imu, IMU_TYPE, wrench, WRENCH_TYPE
from msg_adapters.template import Prepared, STAMP

_XYZ = 'xyz'


def prepared(message: BodyMessage, columns: Mapping[str, int]) -> Prepared:
    """Return the template of a message; ``columns`` are the places of the sample's columns."""
    def at(names: Sequence[str]) -> list[int]:
        return [columns[name] for name in names]
    if isinstance(message, JointStates):
        return joint_state.joint_state(WORLD_FRAME, message.names), joint_state.entries(
            len(message.names), position=at(message.position), velocity=at(message.velocity),
            effort=at(message.effort))
    if isinstance(message, Force):
        return wrench(message.frame or WORLD_FRAME), {**STAMP, **{
            field: columns[name] for name, field in fields_of(message)}}
    if isinstance(message, Odometry):
        return odometry.odometry(WORLD_FRAME, message.frame), {**STAMP, **{
            field: columns[name] for name, field in fields_of(message)}}
    return imu(message.frame, message.sigmas, at([*message.force, *message.turning]))


def type_of(message: BodyMessage) -> str:
    """Return the ROS type of a message."""
    return (joint_state.TYPE if isinstance(message, JointStates)
            else WRENCH_TYPE if isinstance(message, Force)
            else odometry.TYPE if isinstance(message, Odometry) else IMU_TYPE)


def fields_of(message: BodyMessage) -> Iterator[tuple[str, str]]:
    """Yield each published column of the sample with its field of the message."""
    if isinstance(message, JointStates):
        for array in joint_state.ARRAYS:
            yield from ((name, f'{array}[{k}]') for k, name in enumerate(getattr(message, array)))
        return
    if isinstance(message, Odometry):
        yield from zip(message.orientation, (f'pose.pose.orientation.{axis}' for axis in 'wxyz'))
        for vector, names in (('pose.pose.position', message.position),
                              ('twist.twist.linear', message.velocity),
                              ('twist.twist.angular', message.turning)):
            yield from ((name, f'{vector}.{axis}') for name, axis in zip(names, _XYZ))
        return
    vectors = ({'wrench.force': message.force, 'wrench.torque': message.moment}
               if not isinstance(message, Inertial) else {
        'linear_acceleration': message.force, 'angular_velocity': message.turning})
    for vector, names in vectors.items():
        yield from ((name, f'{vector}.{axis}') for name, axis in zip(names, _XYZ))


def by_field(message: BodyMessage) -> Iterator[tuple[str, list[str]]]:
    """Yield each field of the sample that is published whole, with its fields of the message."""
    found: dict[str, list[str]] = {}
    for name, field in fields_of(message):
        found.setdefault(name.partition('[')[0], []).append(field)
    yield from found.items()
