"""Supplies and body of a run: what they feed and show; a saved one goes on byte for byte."""

from dataclasses import replace

from isa_ros.config.assembly import group_of, surroundings_of
from isa_ros.config.paths import CONFIG, find
from isa_ros.config.runs.default_actuator import default_actuator
from isa_ros.config.runs.run_config import RunConfig
from isa_ros.config.runs.run_file import load_run
from isa_ros.config.runs.supplies import SupplyConfig
from isa_ros.core.signals import LOAD_PORT, LOAD_REPLY, START
from isa_ros.errors import ConfigError, ParameterError, RunError, SimulationDiverged
from isa_ros.plant.plant import plant_record
from isa_ros.surroundings.bodies.leg.motion import ContinuousState
from isa_ros.surroundings.feeding import SupplyCircuit
from isa_ros.surroundings.supply import ConstantSupply
from isa_ros.surroundings.supply_sample import SUPPLY_STATE
from isa_ros.surroundings.surroundings import Surroundings
import numpy as np
import pytest
from tests.runs import ACCUMULATOR, CONSTANT, hip_and_knee, RETURN_LINE, run_of
from tests.sheets import setpoint

LEG = load_run(find('leg.yaml', CONFIG))
HELD = LEG.with_body(replace(LEG.leg, start=replace(
    LEG.leg.start, release_s=0.03, foot_height_mm=50.0)))
"""The leg of which the slider is held for 30 ticks."""

RETURNING = ConstantSupply(
    pressure_mpa=20.7, return_pressure_mpa=0.5, return_line=RETURN_LINE)
LOW = ConstantSupply(pressure_mpa=16.0, return_pressure_mpa=0.5)


def fed_by(run: RunConfig, *supplies: SupplyConfig) -> RunConfig:
    return replace(run, supplies=supplies)


@pytest.fixture(scope='module')
def leg() -> RunConfig:
    """Return the leg on a pump with accumulator, and its knee on a return line with a volume."""
    return fed_by(HELD, SupplyConfig('pump', ACCUMULATOR, ('haa', 'hfe')),
                  SupplyConfig('knee', RETURNING, ('kfe',)))


def replies(surroundings: Surroundings, n: int = 3) -> np.ndarray:
    """Return replies of actuators that hold the body and take and give oil."""
    rows = np.zeros(n, LOAD_REPLY)
    rows['mean_forces'] = surroundings.starts()['force'][:, None] + 1.0
    rows['supply_volume'], rows['return_volume'] = 1e-7, 0.5e-7
    return rows


def moved(surroundings: Surroundings, given: np.ndarray, ticks: int) -> list[bytes]:
    """Return everything the surroundings show in some ticks under constant replies."""
    ports, shown = np.zeros(len(given), LOAD_PORT), []
    for _ in range(ticks):
        surroundings.ports(ports)
        surroundings.advance(given)
        shown += [ports.tobytes(), surroundings.supplies.tobytes()]
        shown += [body.sample.tobytes() for body in surroundings.bodies.values()]
    return shown


def test_restored_surroundings_go_on_byte_for_byte(leg):
    """Leg, pump, accumulator and return line; the slider is released when it was to be."""
    surroundings = surroundings_of(leg)
    given = replies(surroundings)
    moved(surroundings, given, 20)
    saved, supplies = surroundings.snapshot(), surroundings.supplies.tobytes()
    rest = moved(surroundings, given, 40)
    assert not surroundings.bodies['body'].is_held
    other = surroundings_of(leg)
    for again in (surroundings, other):
        again.restore(saved)
        assert again.supplies.tobytes() == supplies
        assert again.bodies['body'].is_held
        assert moved(again, given, 40) == rest
        assert again.snapshot() == surroundings.snapshot()


def test_a_state_of_other_surroundings_is_refused(leg):
    rig = surroundings_of(hip_and_knee())
    size = len(rig.snapshot())
    with pytest.raises(ConfigError, match=(
            rf'saved state of the surroundings has \d+ bytes, must have {size}')):
        rig.restore(surroundings_of(leg).snapshot())


def test_what_the_surroundings_show_at_the_start(leg):
    """Pressures of each supply in order; the joints where the leg starts; without one, no body."""
    surroundings = surroundings_of(leg)
    assert surroundings.supplies['pressure'].tolist() == [20.7e6, 20.7e6]
    assert surroundings.supplies['return_pressure'].tolist() == [0.0, 0.5e6]
    start = leg.leg.start
    assert surroundings.bodies['body'].sample['position'][0].tolist() == [
        start.angle(joint) for joint in ('haa', 'hfe', 'kfe')]
    assert surroundings_of(hip_and_knee()).bodies == {}


def test_an_actuator_stands_beside_the_body_by_the_strain_of_its_sensor():
    """S1: x + F/k at each joint; one with a load of its own starts where it is configured."""
    run = replace(LEG, actuators=(default_actuator('isa_v5', 'arm'), *LEG.actuators))
    run = fed_by(run, SupplyConfig('supply', CONSTANT, tuple(a.name for a in run.actuators)))
    surroundings = surroundings_of(run)
    starts = surroundings.starts()
    body = surroundings.bodies['body']
    assert starts['position'][0] == run.actuators[0].initial_position
    assert starts['force'][1:].tolist() == list(body.actuator_forces)
    for row in (1, 2, 3):
        k_s = plant_record(run.actuators[row].sheet.plant)[0].mechanics.k_s
        assert starts['position'][row] == (
            body.actuator_positions[row - 1] + body.actuator_forces[row - 1] / k_s)
    assert (np.abs(starts['force'][2:]) > 10.0).all()


class Cart:
    """A body that one actuator moves, which says in its ports how often it was advanced."""

    def __init__(self, row: int) -> None:
        self.rows = np.array([row])
        self.sample = np.zeros(1, [('height', '<f8')])

    def starts(self, starts: np.ndarray) -> None:
        starts['position'][self.rows], starts['force'][self.rows] = 0.25, 100.0

    def ports(self, ports: np.ndarray) -> None:
        ports['x0'][self.rows] = self.sample['height']

    def advance(self, given: np.ndarray) -> None:
        self.sample['height'] += given['force'][self.rows]

    def snapshot(self) -> bytes:
        return self.sample.tobytes()

    def restore(self, snapshot: bytes) -> None:
        self.sample[:] = np.frombuffer(snapshot, self.sample.dtype)


def test_any_body_is_moved_by_its_own_rows():
    """Whatever it is: ports, forces and snapshot are its own; pressures are the supply's."""
    starts = np.zeros(3, START)
    starts['position'] = 0.1
    circuit = SupplyCircuit('supply', CONSTANT, [0, 1, 2], 1e-12)

    def made() -> Surroundings:
        return Surroundings([circuit], {'cart': Cart(1)}, starts, [1e6, 2e6, 4e6], 1_000_000)
    surroundings = made()
    assert surroundings.starts()['position'].tolist() == [0.1, 0.25 + 100.0 / 2e6, 0.1]
    assert starts['position'].tolist() == [0.1] * 3
    given, ports = np.zeros(3, LOAD_REPLY), np.zeros(3, LOAD_PORT)
    given['force'] = 5.0, 7.0, 9.0
    surroundings.advance(given)
    other = made()
    other.restore(surroundings.snapshot())
    for own in (surroundings, other):
        own.ports(ports)
        assert ports['x0'].tolist() == [0.0, 7.0, 0.0]
        assert ports['supply_pressure'].tolist() == [20.7e6] * 3


def three_actuators(first, second) -> RunConfig:
    """Return a run whose first supply feeds the middle one of three moving actuators."""
    configs = [default_actuator('isa_v5', 'hip'), default_actuator('smart_manifold', 'wrist'),
               default_actuator('isa_v5', 'knee')]
    return run_of(*configs, supplies=[
        SupplyConfig('first', first, ('wrist',)), SupplyConfig('second', second, ('knee', 'hip'))])


@pytest.mark.parametrize(('first', 'second'), [
    (RETURNING, LOW), (LOW, RETURNING),
    (replace(ACCUMULATOR, return_pressure_mpa=0.5), RETURNING)],
    ids=['returning low', 'low returning', 'accumulator returning'])
def test_the_oil_of_each_supply_is_that_of_its_own_actuators(first, second):
    """Drawn and given back, to a thousandth of a microlitre, while all of them move."""
    run = three_actuators(first, second)
    group, surroundings = group_of(run), surroundings_of(run)
    group.start(surroundings.starts())
    for k, actuator in enumerate(group.actuators):
        actuator.accept(setpoint(position=(0.6 + 0.1 * k) * run.actuators[k].initial_position))
    ports, drawn, returned = np.zeros(3, LOAD_PORT), np.zeros(3), np.zeros(3)
    for _ in range(300):
        surroundings.ports(ports)
        given = group.advance(ports)
        drawn += given['supply_volume']
        returned += given['return_volume']
        surroundings.advance(given)
    for volumes, name in ((drawn, 'drawn'), (returned, 'returned')):
        shown = surroundings.supplies[name]
        assert abs(shown[0] - volumes[1]) < 1e-12
        assert abs(shown[1] - (volumes[0] + volumes[2])) < 1e-12
    # Far above the tolerance: leaving one out or taking another's would be seen.
    oil = [*drawn, *returned]
    assert min(oil) > 1e-6
    assert min(abs(a - b) for k, a in enumerate(oil) for b in oil[:k]) > 1e-9


def test_each_actuator_is_under_the_pressures_of_its_own_supply():
    """At t = 0 and at every tick, whatever the order in which a supply feeds."""
    run = three_actuators(LOW, RETURNING)
    surroundings = surroundings_of(run)
    starts, ports = surroundings.starts(), np.zeros(3, LOAD_PORT)
    surroundings.ports(ports)
    for rows in (starts, ports):
        assert rows['supply_pressure'].tolist() == [20.7e6, 16e6, 20.7e6]
        assert rows['return_pressure'].tolist() == [0.5e6] * 3
    given = np.zeros(3, LOAD_REPLY)
    given['return_volume'][0] = 1e-6
    surroundings.advance(given)
    surroundings.ports(ports)
    raised = surroundings.supplies['return_pressure'][1]
    assert ports['return_pressure'].tolist() == [raised, 0.5e6, raised]
    assert raised > 0.6e6


def test_an_actuator_feels_its_return_line():
    """The pressures of both chambers lie between those of its own supply and return line."""
    run = fed_by(hip_and_knee(), SupplyConfig('low', LOW, ('hip',)),
                 SupplyConfig('high', replace(LOW, return_pressure_mpa=3.0), ('knee',)))
    group, surroundings = group_of(run), surroundings_of(run)
    group.start(surroundings.starts())
    ports = np.zeros(2, LOAD_PORT)
    for _ in range(200):
        surroundings.ports(ports)
        surroundings.advance(group.advance(ports))
    for row, tank in enumerate((0.5e6, 3.0e6)):
        for chamber in 'ab':
            assert tank < group.samples[f'pressure_{chamber}'][row] < 16e6


def test_a_supply_too_small_is_refused_by_its_name():
    """The first one feeds one actuator, and is large enough for it."""
    small = replace(ACCUMULATOR, gas_volume_l=1e-3, line_volume_l=1e-3)
    with pytest.raises(ParameterError, match='^second: capacitance over flow slope = '):
        surroundings_of(three_actuators(LOW, small))


@pytest.mark.parametrize('value', [np.nan, np.inf])
def test_a_supply_that_is_not_finite_is_neither_written_nor_read(leg: RunConfig, value: float):
    surroundings, twin = surroundings_of(leg), surroundings_of(leg)
    saved = bytearray(surroundings.snapshot())
    at = SUPPLY_STATE.itemsize      # pressure of the second supply
    saved[at:at + 8] = np.float64(value).tobytes()
    with pytest.raises(ConfigError, match=f'^knee: saved state has pressure = {value}, must be'):
        twin.restore(bytes(saved))
    assert twin.snapshot() == surroundings.snapshot()
    surroundings.supplies['pressure'][1] = value
    with pytest.raises(RunError, match=f'^knee: pressure = {value}, must be finite to be saved'):
        surroundings.snapshot()


@pytest.mark.parametrize('value', [np.nan, -np.inf])
def test_a_leg_that_is_not_finite_is_neither_written_nor_read(leg: RunConfig, value: float):
    surroundings, body = surroundings_of(leg), surroundings_of(leg).bodies['body']
    saved = bytearray(body.snapshot())
    saved[16:24] = np.float64(value).tobytes()      # behind its time and the first number
    field = ContinuousState._fields[1]
    with pytest.raises(ConfigError, match=f'^leg: saved state has {field} = {value}, must be'):
        body.restore(bytes(saved))
    body._state[field] = value
    with pytest.raises(SimulationDiverged, match=f'^leg.{field} = {value} at t = 0'):
        body.snapshot()
    time = (1).to_bytes(8, 'little')
    with pytest.raises(ConfigError, match='^leg: saved state at t = 1 ns, must be a multiple'):
        surroundings.bodies['body'].restore(time + surroundings.bodies['body'].snapshot()[8:])
