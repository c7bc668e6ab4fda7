"""The messages of an actuator at a tick, prepared."""

from collections.abc import Mapping

from msg_adapters import applied_parameters, device, joint_state, setpoint
from msg_adapters.sensor_messages import (
    fluid_pressure, load_cell, PRESSURE_TYPE, TEMPERATURE_TYPE, WRENCH_TYPE)
from msg_adapters.template import Prepared

STATE_TOPICS = (
    ('joint_states', joint_state.TYPE),
    ('load_cell', WRENCH_TYPE),
    ('pressure_a', PRESSURE_TYPE),
    ('pressure_b', PRESSURE_TYPE),
    ('references', joint_state.TYPE),
    ('valve', joint_state.TYPE),
)
"""(topic suffix, type) of the messages published at every tick, sorted by suffix."""

APPLIED_SETPOINT = ('applied_setpoint', joint_state.TYPE)
APPLIED_PARAMETERS = ('applied_parameters', applied_parameters.TYPE)
APPLIED_TOPICS = (APPLIED_PARAMETERS, APPLIED_SETPOINT)
"""(topic suffix, type) of the messages published when a command or parameter takes effect."""

DEVICE = ('device', device.TYPE)
"""(topic suffix, type) of the device's status, published on change and every second."""

SENT_SETPOINT = ('sent_setpoint', joint_state.TYPE)
"""(topic suffix, type) of the messages published when a command is handed to a link."""
KEPT_TOPICS = (*APPLIED_TOPICS, SENT_SETPOINT, DEVICE)
"""(topic suffix, type) of the messages that are kept for later subscriptions."""

TOPICS = (*APPLIED_TOPICS, DEVICE, *STATE_TOPICS)
APPLIED_PLACE = TOPICS.index(APPLIED_SETPOINT)
"""Of the applied setpoint among an actuator's messages."""

TEMPERATURE = ('temperature', TEMPERATURE_TYPE)
"""(topic suffix, type) of the oil's temperature: once a second, of actuators that get warm."""

CUSHION_PRESSURE = ('cushion_pressure', PRESSURE_TYPE)
"""(topic suffix, type) of the pressure behind a spear: of cylinders with cushioned ends."""


def topics(
        is_heated: bool = False, has_link: bool = False,
        is_cushioned: bool = False) -> tuple[tuple[str, str], ...]:
    """Return (topic suffix, type) of all messages of an actuator."""
    return (*APPLIED_TOPICS, *([SENT_SETPOINT] if has_link else []), DEVICE, *STATE_TOPICS,
            *([CUSHION_PRESSURE] if is_cushioned else []), *([TEMPERATURE] if is_heated else []))


def prepared(
        name: str, is_rotary: bool, sample: Mapping[str, int], absolute: Mapping[str, int],
        applied: Mapping[str, int]) -> dict[str, Prepared]:
    """
    Return the prepared messages of an actuator by topic suffix.

    Those of `APPLIED_PARAMETERS` and `DEVICE` contain texts and cannot be prepared.

    The arguments are columns of values by field: ``sample`` for its `SAMPLE`, ``absolute`` for its
    pressures in Pa absolute, ``applied`` for its applied `COMMAND`. Frames: ``NAME_load_cell`` of
    the load cell, ``NAME`` for the rest; the shipped URDFs have links of these names.
    """
    return {
        'applied_setpoint': setpoint.applied_setpoint(name, applied),
        'joint_states': joint_state.actuator_joint_state(name, sample),
        'load_cell': load_cell(name, is_rotary, sample),
        'pressure_a': fluid_pressure(name, absolute['pressure_a']),
        'pressure_b': fluid_pressure(name, absolute['pressure_b']),
        'references': joint_state.references(name, sample),
        'valve': joint_state.valve(name, sample),
    }
