"""The load of an actuator changes during a run: force, inertia, the place of its support."""

from isa_ros.actuator.actuator import SmartActuator
from isa_ros.actuator.group import ActuatorGroup
from isa_ros.actuator.tunable import changing
from isa_ros.config.runs.run_config import ActuatorConfig
from isa_ros.core.signals import COMMAND, LOAD_PORT
from isa_ros.errors import ConfigError
from isa_ros.loads.sheets import Blocked, LocalLoad, Mass
import numpy as np
import pytest
from tests.sheets import actuator_sheet, MODELS, own_load, setpoint, smart_actuator, TICK

FORCE, INERTIA, PLACE = 'load.force', 'load.inertia', 'load.displacement'
KINDS = [(model, kind) for model in MODELS for kind in ('blocked', 'wheel', 'mass', 'wood')]
SECOND = 1_000_000_000 // TICK.step_ns


def ticks(actuator: SmartActuator, n: int) -> list[bytes]:
    """Advance by n ticks and return the samples' bytes."""
    samples = []
    for _ in range(n):
        actuator.tick()
        samples.append(actuator.sample.tobytes())
    return samples


def held(load: LocalLoad, stiffness: float = 1e5, damping: float = 4000.0) -> SmartActuator:
    """Return an ISA v5 at rest that holds 50 mm by an impedance."""
    actuator = smart_actuator('isa_v5', load, timing=TICK, position=0.05)
    actuator.accept(setpoint(position=0.05, stiffness=stiffness, damping=damping))
    return actuator


@pytest.mark.parametrize(('model', 'kind'), KINDS)
def test_every_load_has_a_force_and_an_inertia_that_may_change(model: str, kind: str) -> None:
    """And a support its place; of a body that actuators move there are none."""
    sheet = actuator_sheet(model)
    found = [name for name in changing(sheet, own_load(model, kind)) if name.startswith('load.')]
    assert found == [INERTIA, FORCE] + [PLACE] * (kind == 'blocked')
    assert not any(name.startswith('load.') for name in changing(sheet, None))


@pytest.mark.parametrize('stiffness', [5e4, 2e5])
@pytest.mark.parametrize('force', [-500.0, 300.0])
def test_under_a_step_of_force_an_impedance_yields_by_force_over_stiffness(
        stiffness: float, force: float) -> None:
    """P1 at rest: F/k, within the Coulomb friction's share and a step of the encoder; and back."""
    actuator = held(Mass(inertia=50.0, force=0.0), stiffness)
    ticks(actuator, SECOND // 5)
    before = actuator.sample.position
    actuator.tune({FORCE: force})
    ticks(actuator, SECOND // 2)
    # the integral of the force block removes the friction; 8 N are a code of the load cell
    assert actuator.sample.position - before == pytest.approx(
        force / stiffness, abs=8.0 / stiffness + 2e-6)
    assert actuator.sample.force == pytest.approx(-force, abs=8.0)
    actuator.tune({FORCE: 0.0})
    ticks(actuator, SECOND // 2)
    assert actuator.sample.position == pytest.approx(before, abs=8.0 / stiffness + 2e-6)


@pytest.mark.parametrize(('change', 'load'), [
    ({INERTIA: 80.0}, Mass(inertia=80.0, force=0.0)),
    ({FORCE: 200.0}, Blocked(inertia=2.0, stiffness=1e7, damping=2e3, force=200.0)),
    ({INERTIA: 3.0}, Blocked(inertia=3.0, stiffness=1e7, damping=2e3)),
])
def test_a_change_before_the_first_tick_acts_as_if_it_stood_in_the_sheet(
        change: dict[str, float], load: LocalLoad) -> None:
    """Stiffness and damping of a support are per its inertia  (L1)."""
    sheet = (Mass(inertia=50.0, force=0.0) if isinstance(load, Mass)
             else Blocked(inertia=2.0, stiffness=1e7, damping=2e3))
    changed, written, untouched = (held(own) for own in (sheet, load, sheet))
    changed.tune(change)
    for own in (changed, written, untouched):
        own.accept(setpoint(position=0.06, effort=900.0))
    samples = ticks(changed, 60)
    assert samples == ticks(written, 60)
    assert samples != ticks(untouched, 60)


def test_a_support_moves_at_constant_speed_during_one_tick() -> None:
    """L1: x_r = x_0 + v_0 t; the next tick it rests at its new place."""
    actuator = held(Blocked(inertia=1.0, stiffness=1e8, damping=1e4), stiffness=0.0, damping=0.0)
    port, tick = actuator.memory.ports[0], TICK.step_ns * 1e-9
    ticks(actuator, 3)
    assert (port['x0'], port['v0']) == (0.05, 0.0)
    actuator.tune({PLACE: 1e-4})
    for place, speed in ((0.05, 1e-4 / tick), (0.05 + 1e-4, 0.0), (0.05 + 1e-4, 0.0)):
        ticks(actuator, 1)
        assert (port['x0'], port['v0']) == (place, pytest.approx(speed, rel=1e-12, abs=0.0))
    actuator.tune({PLACE: -2e-4})
    ticks(actuator, 1)
    assert port['x0'] == 0.05 + 1e-4
    assert port['v0'] == pytest.approx(-3e-4 / tick, rel=1e-9, abs=0.0)


def test_what_is_held_by_a_support_moves_with_it() -> None:
    """A force loop of 0 N gives way: the rod is where the support is, within F/k of the load."""
    actuator = held(Blocked(inertia=1.0, stiffness=3e7, damping=2e3), stiffness=0.0, damping=0.0)
    for k in range(SECOND // 2):
        actuator.tune({PLACE: 2e-3 * min(1.0, k / (SECOND // 4))})
        ticks(actuator, 1)
    ticks(actuator, SECOND // 2)
    # 150 N are twice the stiction, 30 MN/m; the load cell's deflection is less
    assert actuator.sample.position == pytest.approx(0.052, abs=2.0 * 150.0 / 3e7)


def test_a_saved_state_continues_in_the_tick_in_which_a_support_moves() -> None:
    load = Blocked(inertia=1.0, stiffness=3e7, damping=2e3)
    whole, again = held(load), held(load)
    ticks(whole, 5)
    whole.tune({PLACE: 1e-4, FORCE: 50.0})
    for _ in range(3):      # accepted, moving, at rest
        again.restore(whole.snapshot())
        assert ticks(again, 4) == ticks(held_from(whole), 4)
        ticks(whole, 1)


def held_from(actuator: SmartActuator) -> SmartActuator:
    """Return another actuator that continues from the state of one."""
    other = held(Blocked(inertia=1.0, stiffness=3e7, damping=2e3))
    ticks(other, 2)
    other.tune({PLACE: -1e-3, FORCE: 7.0})
    ticks(other, 1)
    other.restore(actuator.snapshot())
    return other


def test_a_run_begins_again_with_the_load_of_its_sheet() -> None:
    """Changes stay accepted, in force from the first tick on, as gains do."""
    actuator = held(Mass(inertia=50.0, force=0.0))
    actuator.tune({FORCE: -200.0})
    first = ticks(actuator, 30)
    actuator.start(0.05, 0.0, 20.7e6, 0.0)
    assert actuator.memory.ports['a_bias'][0] == 0.0
    actuator.accept(setpoint(position=0.05, stiffness=1e5, damping=4000.0))
    assert ticks(actuator, 30) == first


@pytest.mark.parametrize('n', [1, 2, 40])
def test_many_ticks_with_a_moving_support_are_as_many_calls(n: int) -> None:
    """It moves in the first of them only."""
    sheet, load = actuator_sheet('isa_v5'), own_load('isa_v5', 'blocked')
    config = ActuatorConfig('ram', 'isa_v5', 'default', sheet, load, 0.05)
    many, single = ActuatorGroup([config], TICK), ActuatorGroup([config], TICK)
    ports, none = np.zeros(1, LOAD_PORT), np.zeros((n, 1), COMMAND)
    ports['supply_pressure'] = 20.7e6
    for group in (many, single):
        group.actuators[0].tune({PLACE: 1e-4})
    log = many.advance_many(ports, none)
    rows = [single.samples.tobytes()]
    for _ in range(n):
        single.advance(ports)
        rows.append(single.samples.tobytes())
    assert [row.tobytes() for row in log.samples] == rows
    assert many.snapshot() == single.snapshot()


@pytest.mark.parametrize(('model', 'values', 'message'), [
    ('isa_v5', {FORCE: 3e7}, 'load.force = 3e[+]07 N, must be <= 2e[+]07 N '),
    ('isa_v5', {INERTIA: 0.0}, 'load.inertia = 0 kg, must be > 0 kg '),
    ('isa_v5', {PLACE: 0.1}, 'load.displacement is unknown'),
    ('isa_v5', {INERTIA: 1e-6}, 'load.inertia = 1e-06 kg, must be >= [0-9.]+ kg.*plant step'),
])
def test_a_load_that_cannot_be_is_refused_and_nothing_changes(
        model: str, values: dict[str, float], message: str) -> None:
    actuator = smart_actuator(model, 'mass', timing=TICK)
    with pytest.raises(ConfigError, match=message):
        actuator.tune({'force.kp': 1e-8, **values})
    assert actuator.parameter('force.kp') == actuator.sheet.reu.force.kp
    assert actuator.parameter(INERTIA) == 50.0


def test_an_actuator_of_a_body_has_no_load_to_change() -> None:
    actuator = smart_actuator('isa_v5', None, timing=TICK)
    with pytest.raises(ConfigError, match='isa_v5: load.force is not used: the actuator moves a'):
        actuator.tune({FORCE: 1.0})
