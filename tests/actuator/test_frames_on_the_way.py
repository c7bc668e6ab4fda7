"""Frames of a link on their way in a snapshot, in a group and in the compiled exchange."""

from isa_ros.actuator import link as links
from isa_ros.actuator.actuator import SmartActuator
from isa_ros.actuator.frames import SLOTS
from isa_ros.actuator.group import ActuatorGroup
from isa_ros.actuator.rows import Memory
from isa_ros.config.runs.run_config import ActuatorConfig
from isa_ros.errors import ConfigError
import numpy as np
import pytest
from tests.actuator.linked import actuator, linked, MODEL, STEPS
from tests.sheets import actuator_sheet, own_load, setpoint, TICK


def exchanged(is_compiled: bool) -> bytes:
    """Return a memory after 30 ticks of frames alone, by kernels or by their Python source."""
    own = actuator(linked(**LOSSY))
    memory = Memory(*(rows.view(np.recarray) if rows.dtype.names else rows for rows in own.memory))
    kernels = [links.hand_over, links.exchange_frames, links.send_sample, links.receive_samples]
    hand_over, exchange, send, receive = (
        kernels if is_compiled else [kernel.py_func for kernel in kernels])
    for k in range(30):
        own.accept(setpoint(position=0.05 + 1e-4 * k))
        hand_over(50 * k, 0, memory)
        for step in range(STEPS * k, STEPS * (k + 1)):
            memory.samples.position[0] = step
            is_sampled = step > STEPS * k and step % (STEPS // 2) == 0
            exchange(step, is_sampled, 0, memory)
        send(STEPS * (k + 1), 0, memory)
        receive(STEPS * (k + 1), 0, memory)
    assert memory.observed.position[0] > 0.0 and memory.applied.due_step[0] > 0
    return b''.join(rows.tobytes() for rows in memory)


def test_compiled_frames_equal_their_python_source():
    assert exchanged(True) == exchanged(False)


LOSSY = {'cycle_ms': 0.5, 'delay_cycles': 2, 'jitter_us': 300.0, 'loss': 0.3, 'watchdog_ms': 3.0}


def driven(own: SmartActuator, ticks: range) -> list[bytes]:
    """Advance with a setpoint at every tick; return what is sent, applied and observed."""
    seen = []
    for k in ticks:
        own.accept(setpoint(position=0.05 + 1e-4 * (k % 7)))
        own.tick()
        memory = own.memory
        seen.append(b''.join(rows.tobytes() for rows in (
            memory.samples, memory.observed, memory.applied, memory.sent, memory.reu)))
    return seen


def test_a_restored_link_goes_on_with_its_frames_on_their_way():
    whole, first = actuator(linked(**LOSSY)), actuator(linked(**LOSSY))
    expected = driven(whole, range(60))
    driven(first, range(31))
    assert first.memory.links['down']['count'][0] > 0
    second = actuator(linked(**LOSSY))
    second.restore(first.snapshot())
    assert driven(second, range(31, 60)) == expected[31:]
    whole.start(*[0.5 * actuator_sheet(MODEL).plant.drive.stroke, 0.0, 20.7e6, 0.0])
    assert whole.memory.links['down']['count'][0] == 0


def test_a_snapshot_has_frames_only_behind_a_link():
    direct, behind = actuator(), actuator(linked())
    frames = sum(getattr(behind.memory, name).nbytes for name in (
        'links', 'sent', 'outbox', 'commands_sent', 'samples_sent', 'observed'))
    frames += behind.tuning.nbytes - direct.tuning.nbytes   # what is tuned is on its way too
    assert behind.tuning.nbytes > direct.tuning.nbytes
    assert len(behind.snapshot()) - len(direct.snapshot()) == frames


@pytest.mark.parametrize('field, value', [('first', SLOTS), ('first', -1), ('count', 99)])
def test_a_saved_state_with_an_impossible_line_is_refused(field, value):
    """Its slots would lie in other memory."""
    own = actuator(linked())
    own.memory.links['up'][field] = value
    with pytest.raises(ConfigError, match=f'{field} = {value} of a link, must be 0 to'):
        own.restore(own.snapshot())


def test_actuators_of_one_group_have_the_frames_that_they_have_alone():
    load, x = own_load(MODEL, 'mass'), 0.05
    configs = [ActuatorConfig(name, MODEL, 'default', sheet, load, x) for name, sheet in (
        ('hip', linked(**LOSSY)), ('knee', actuator_sheet(MODEL)), ('toe', linked(**LOSSY)))]
    group = ActuatorGroup(configs, TICK)
    alone = [SmartActuator(config, TICK) for config in configs]
    ports = group._memory.ports.copy()
    for k in range(40):
        for own in (*group.actuators, *alone):
            own.accept(setpoint(position=0.05 + 1e-4 * (k % 7)))
        group.advance(ports)
        for own in alone:
            own.tick()
        for name in ('observed', 'applied', 'sent', 'links'):
            assert getattr(group._memory, name).tobytes() == b''.join(
                getattr(own.memory, name).tobytes() for own in alone), (k, name)
    hip, _, toe = group.observed['age']
    assert {hip, toe} != {0.0} and group._memory.links['down'][0] != group._memory.links['down'][2]
