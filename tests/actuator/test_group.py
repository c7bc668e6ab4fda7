"""Actuators of one process, ticked together."""

from dataclasses import replace

from isa_ros.actuator.actuator import SmartActuator
from isa_ros.config.default_actuator import default_actuator, DEFAULT_TIMING
from isa_ros.core.signals import HAS_SETPOINT, LOAD_PORT
from isa_ros.errors import SimulationDiverged
from isa_ros.run.group import ActuatorGroup
from msg_adapters.actuator_messages import APPLIED_SETPOINT, APPLIED_TOPICS
import numpy as np
import pytest
from tests.sheets import MODELS, setpoint

SETPOINT = APPLIED_TOPICS.index(APPLIED_SETPOINT)
CONFIGS = [
    *(default_actuator(model, model) for model in MODELS),
    replace(default_actuator('isa_v5', 'at_a_joint'), load=None)]


def ports(tick: int) -> np.ndarray:
    """Return a port of every actuator; the last one's load is shared and moves."""
    rows = np.zeros(len(CONFIGS), LOAD_PORT)
    rows['supply_pressure'] = 20.7e6 - 1e4 * tick
    rows['x0'] = CONFIGS[-1].initial_position + 1e-5 * tick
    rows['v0'], rows['inverse_mass'], rows['a_bias'] = 0.01, 0.02, 0.1
    return rows


def test_together_they_do_what_each_does_alone():
    """Bit for bit: states, setpoints in between, replies and messages."""
    group = ActuatorGroup(CONFIGS, DEFAULT_TIMING)
    alone = [SmartActuator(config, DEFAULT_TIMING) for config in CONFIGS]
    for tick in range(20):
        if tick % 7 == 3:
            for member, actuator in zip(group.members, alone):
                command = setpoint(position=float(actuator.sample.position) + 1e-3)
                member.actuator.accept(command)
                actuator.accept(command)
        applied = group.advance(ports(tick))
        for k, actuator in enumerate(alone):
            actuator.tick(ports(tick)[k])
            assert group.members[k].actuator.snapshot() == actuator.snapshot()
            assert group.replies[k].tobytes() == actuator.reply.tobytes()
            assert group.samples[k].tobytes() == actuator.sample.tobytes()
            assert (applied[k][SETPOINT] is not None) == bool(
                actuator.applied is not None and actuator.applied.kinds & HAS_SETPOINT)
    assert group.states() == [member.states() for member in group.members]


def test_the_one_that_diverges_is_named():
    group = ActuatorGroup(CONFIGS, DEFAULT_TIMING)
    given = ports(0)
    given['supply_pressure'][1] = np.nan
    with pytest.raises(SimulationDiverged, match=rf'^{MODELS[1]}: plant\.\S+ = nan at t = 0.001'):
        group.advance(given)
