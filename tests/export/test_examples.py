"""The examples beside a library: built as their text says, their samples those of our runs."""

import re
import subprocess

from isa_ros.actuator.actuator import SmartActuator
from isa_ros.config.assembly import timing_of
from isa_ros.core.signals import COMMAND, HAS_SETPOINT, LOAD_PORT, SAMPLE
from isa_ros.export.chosen import choose
from isa_ros.export.exported import exported
import numpy as np
import pytest
from tests.export.libraries import written

pytestmark = pytest.mark.slow

ACTUATORS = {'isa_v5': {}, 'rig_linear': {}, 'leg:haa': {}, 'leg:kfe': {}}
STRICT = ('-Wall', '-Wextra', '-Wpedantic', '-Werror')


@pytest.fixture(scope='module', params=ACTUATORS)
def made(request, tmp_path_factory):
    """Return an exported actuator, and the directory with its library."""
    own = exported(choose(request.param))
    return own, written(own, tmp_path_factory.mktemp('examples')).parent


def built(directory, example):
    """Build an example by the command in its first lines, with all warnings; return its path."""
    text = (directory / example).read_text()
    command = re.search(r'\*   (c\S+ -std=.*? -o example)', text)[1]
    subprocess.run(command.replace('-o example', f'-o {example}.out {" ".join(STRICT)}'),
                   shell=True, check=True, cwd=directory)
    return directory / f'{example}.out'


def samples_of(program, directory):
    """Run a program; return its samples and what it prints."""
    out = directory / 'samples.bin'
    done = subprocess.run([program, out], capture_output=True, text=True, check=True)
    return np.fromfile(out, SAMPLE), done.stdout


class Mass:
    """The load of the example in C."""

    def __init__(self, inertia, position):
        self.inertia, self.position, self.velocity = inertia, position, 0.0

    def advance(self, reply, tick):
        """Move by a tick."""
        h = tick / 5
        for force in reply.mean_forces.tolist():
            acceleration = force / self.inertia
            self.position += h * (self.velocity + h / 2 * acceleration)
            self.velocity += h * acceleration


def setpoint(position):
    """Return a `COMMAND` that keeps the gains."""
    row = np.zeros(1, COMMAND)[0]
    row['kinds'], row['position'] = HAS_SETPOINT, position
    row['stiffness'] = row['damping'] = np.nan
    return row


def actuator_of(own):
    """Return the same actuator in Python, started as it is in the run."""
    actuator = SmartActuator(own.chosen.config, timing_of(own.chosen.run))
    actuator.start(*own.start[0].item())
    return actuator


def place_of(actuator):
    """Return where the load of an actuator is."""
    return float(actuator.memory.continuous['load']['position'][0])


def port_of(own, position, velocity=0.0, inverse_mass=0.0):
    """Return the `LOAD_PORT` of a load at a place."""
    port = np.zeros(1, LOAD_PORT)[0]
    port['x0'], port['v0'], port['inverse_mass'] = position, velocity, inverse_mass
    for name in ('supply_pressure', 'return_pressure'):
        port[name] = own.start[name][0]
    return port


def test_all_samples_of_the_example_in_c(made):
    own, directory = made
    found, printed = samples_of(built(directory, 'example.c'), directory)
    actuator, start = actuator_of(own), float(own.start['position'][0])
    mass = Mass(0.5 if actuator.is_rotary else 50.0, place_of(actuator))
    step = 0.1 if actuator.is_rotary else 0.005
    expected = [actuator.sample.copy()]
    for k in range(1000):
        if k in (100, 500):
            actuator.accept(setpoint(start + (step if k == 100 else 0.0)))
        actuator.tick(port_of(own, mass.position, mass.velocity, 1.0 / mass.inertia))
        mass.advance(actuator.reply, 1e-9 * 1_000_000)
        expected.append(actuator.sample.copy())
    assert len(found) == 1001 and np.array(expected).tobytes() == found.tobytes()
    assert np.ptp(found['position']) > 0.9 * step
    name = own.chosen.config.name
    count = len(own.chosen.parameters())
    assert re.match(rf'{name}, model \w+, isa_ros [\d.]+, {count} parameters\n', printed)
    assert len(printed.splitlines()) == 11


def test_all_samples_of_the_example_in_cpp(made):
    own, directory = made
    found, printed = samples_of(built(directory, 'example.cpp'), directory)
    start = float(own.start['position'][0])
    expected = []
    for sign in (1.0, -1.0):
        actuator = actuator_of(own)
        step = 0.02 if actuator.is_rotary else 0.001
        place = place_of(actuator)
        expected.append(actuator.sample.copy())
        for k in range(500):
            if k == 100:
                actuator.accept(setpoint(start + sign * step))
            actuator.tick(port_of(own, place))
            expected.append(actuator.sample.copy())
    assert len(found) == 1002 and np.array(expected).tobytes() == found.tobytes()
    assert found[500].tobytes() != found[1001].tobytes()
    assert printed.startswith('501 samples each, ')
