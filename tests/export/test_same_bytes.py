"""An exported actuator gives the bytes of runs and bags: rows in, rows out, at every tick."""

from typing import NamedTuple

import isa_ros
from isa_ros.config.text.yaml_text import parse
from isa_ros.core.device import FIELDS
from isa_ros.core.signals import SAMPLE
from isa_ros.export.chosen import ChosenActuator
from isa_ros.export.exported import exported
from isa_ros.tick.exchange import RowSink
import numpy as np
import pytest
from tests.export.libraries import BEHIND, Instance, Loaded, written

pytestmark = pytest.mark.slow

MOTIONS = parse("""
name: motions
duration_s: 0.6
tracks:
  ram:
  - {t_s: 0.0, position: hold, stiffness: 2.0e+5, damping: 4000.0}
  - {t_s: 0.1, position: 0.06}
  - {t_s: 0.2, position: 0.055, sine: {amplitude: 0.004, frequency_hz: 8.0, moves: position}}
  - {t_s: 0.4, position: 0.05, effort: 300.0}
""", 'motions')
LINK = {'kind': 'ethercat', 'cycle_ms': 1.0, 'delay_cycles': 1, 'jitter_us': 100.0, 'loss': 0.1,
        'duplicates': 0.05, 'reordered': 0.05}
ACCUMULATOR = {
    'kind': 'accumulator', 'pressure_mpa': 20.7, 'return_pressure_mpa': 0.0, 'gas_volume_l': 0.32,
    'precharge_mpa': 12.0, 'polytropic_exponent': 1.3, 'line_volume_l': 0.5,
    'bulk_modulus': 1.0e9, 'pump_flow_lpm': 12.0, 'pump_lag_s': 0.03, 'pump_band_mpa': 0.5,
    'relief_mpa': 22.5, 'relief_lpm_per_mpa': 10.0}
RUNS = {
    'own_load': ('rig_linear', MOTIONS, 'ram', {}),
    'linear_in_a_leg': ('leg', 'drop', 'kfe', {}),
    'rotary_in_a_leg': ('leg', 'drop', 'haa', {}),
    'link': ('leg', 'drop', 'hfe', {'link': LINK}),
    'accumulator': ('leg', 'drop', 'hfe', {'supply': ACCUMULATOR}),
    'torque_step': ('rig_rotary', 'step', 'rotor', {}),
    'rope': ('rig_rotary', 'weight', 'rotor', {})}


BY_DEVICE = (*FIELDS, 'largest_cavity')     # in messages of changes, not of ticks


class Tick(NamedTuple):
    """What crosses in a tick of one actuator, copied."""

    port: np.void
    feed: np.void
    command: np.void
    rows: dict
    """By name, at the end of the tick."""


class Captured(RowSink):
    """Keeps what crosses at one actuator of a simulation."""

    def __init__(self, simulation, row):
        self._rows, self._row, self._group = simulation.loop.rows, row, simulation.group
        self._given = None
        self.samples, self.ticks, self.states = [], [], []

    def record(self):
        """Keep what the actuator gets, after it was filled."""
        rows = self._rows
        self._given = [own[self._row].copy() for own in (rows.ports, rows.feeds, rows.commands)]

    def take(self, tick, rows):
        """Keep what it returns."""
        self.samples.append(rows.samples[self._row].copy())
        self.states.append(self._group.actuators[self._row].snapshot())
        if self._given is not None:
            self.ticks.append(Tick(*self._given, {
                'reply': rows.replies[self._row].copy(), 'fed': rows.fed[self._row].copy(),
                'applied': rows.applied[self._row].copy()}))


class Case(NamedTuple):
    """A run, what crossed in it, and its actuator as a library."""

    result: isa_ros.Result
    row: int
    captured: Captured
    loaded: Loaded
    directory: object


@pytest.fixture(scope='module', params=RUNS)
def case(request, tmp_path_factory):
    """Return a run with its library."""
    name, scenario, actuator, changes = RUNS[request.param]
    run = isa_ros.load(name, scenario, changes=changes, duration=0.6)
    simulation = run.simulation()
    row = simulation.names.index(actuator)
    captured = Captured(simulation, row)
    simulation.loop.sinks = (captured,)
    simulation.loop.run(simulation.scenario.n_ticks)
    own = exported(ChosenActuator(simulation.scenario.run, {}, row, {}))
    directory = tmp_path_factory.mktemp(request.param)
    return Case(run.simulate(), row, captured, Loaded(written(own, directory), own.word),
                directory)


def test_every_row_of_every_tick_is_the_same(case):
    instance = Instance(case.loaded)
    assert instance.sample == case.captured.samples[0]
    for k, tick in enumerate(case.captured.ticks):
        assert instance.tick(tick.port, tick.command, tick.feed) == 0
        assert instance.sample.tobytes() == case.captured.samples[k + 1].tobytes(), k
        for name, row in tick.rows.items():
            assert getattr(instance, name).tobytes() == row.tobytes(), (k, name)
    assert instance.t_ns == 600_000_000 and len(case.captured.ticks) == 600


def test_the_load_of_the_first_port_is_where_the_start_has_it(case):
    """To the rounding of a difference: a body says where it is, a start where its piston is."""
    if case.captured.ticks[0].port['x0'] != 0.0:
        place = Instance(case.loaded).load_position
        assert abs(place - case.captured.ticks[0].port['x0']) <= 1e-15


def test_the_run_moves(case):
    """Otherwise equal samples would say little."""
    samples = np.array(case.captured.samples)
    assert np.ptp(samples['spool']) > 1e-6 and np.ptp(samples['force']) > 1.0
    commands = np.array([tick.command['kinds'] for tick in case.captured.ticks])
    assert commands.any()


def test_the_samples_are_those_of_the_bag(case, tmp_path):
    bag = isa_ros.read(case.result.save(tmp_path / 'bag')).log.samples[:, case.row]
    instance = Instance(case.loaded)
    samples = [instance.sample]
    for tick in case.captured.ticks:
        assert instance.tick(tick.port, tick.command, tick.feed) == 0
        samples.append(instance.sample)
    own = np.array(samples)
    recorded = [name for name in SAMPLE.names
                if name not in BY_DEVICE and not np.isnan(bag[name]).any()]
    assert len(bag) == len(own) == 601 and len(recorded) == 14
    for name in recorded:
        assert bag[name].tobytes() == own[name].tobytes(), name


def test_saved_states_are_those_of_python(case):
    """Digest and checksum follow; a state of a run goes on in the library, and the other way."""
    instance, other = Instance(case.loaded), Instance(case.loaded)
    ticks, states = case.captured.ticks, case.captured.states
    for k, tick in enumerate(ticks[:300]):
        instance.tick(tick.port, tick.command, tick.feed)
        if k in (0, 150, 299):
            assert instance.save().tobytes()[:-BEHIND] == states[k + 1]
    assert other.restore(instance.save()) == 0
    assert other.sample.tobytes() == case.captured.samples[300].tobytes()
    assert other.t_ns == 300_000_000
    for k, tick in enumerate(ticks[300:]):
        assert other.tick(tick.port, tick.command, tick.feed) == 0
        assert other.sample.tobytes() == case.captured.samples[301 + k].tobytes()


def test_a_second_start_is_as_the_first(case):
    instance = Instance(case.loaded)
    first = instance.save().tobytes()
    for tick in case.captured.ticks[:120]:
        instance.tick(tick.port, tick.command, tick.feed)
    assert instance.save().tobytes() != first
    assert instance.start() == 0
    assert instance.save().tobytes() == first and instance.t_ns == 0
    assert instance.tick(*(case.captured.ticks[0][k] for k in (0, 2, 1))) == 0
    assert instance.sample.tobytes() == case.captured.samples[1].tobytes()
