"""Each named fault of a pump, valve, hose or filter of a supply acts as its physics says."""

import math
from typing import Any

from isa_ros.analysis.faults.rigs import rig_of
from isa_ros.config.models.fault_catalogue import fault_catalogue
import numpy as np
import pytest
from tests.analysis.faults.part_runs import ATMOSPHERE, BEGIN, LPM, MPA, pair, run, SECONDS

LEAK = LPM / MPA            # 1 l/min/MPa

pytestmark = pytest.mark.filterwarnings('ignore::isa_ros.TripWarning')


def flow(result: Any, part: str) -> Any:
    """Return what flows through a part, l/min."""
    return result[f'station/{part}.pump_flow'] / LPM


def pressure(result: Any, part: str) -> Any:
    """Return the pressure at the inlet of a part, MPa."""
    return result[f'station/{part}.pressure'] / MPA


def test_a_worn_pump_delivers_less_at_once() -> None:
    """By 1 l/min/MPa of its pressure, before its compensator notices."""
    sound, faulty = pair('pump_worn')
    less = flow(sound, 'pump')[BEGIN + 1] - flow(faulty, 'pump')[BEGIN + 1]
    assert less == pytest.approx(pressure(faulty, 'gallery')[BEGIN + 1], rel=0.01)


def test_a_stuck_pump_does_not_answer_the_pressure() -> None:
    """But for its leakage of 0.05 l/min/MPa."""
    sound, faulty = pair('pump_stuck')
    given = flow(faulty, 'pump') + 0.05 * pressure(faulty, 'gallery')
    assert np.ptp(given[BEGIN + 1:]) < 1e-3 < 5.0 < np.ptp(flow(sound, 'pump')[BEGIN:])


@pytest.mark.parametrize('name', ['pump_trip', 'supply_low'])
def test_a_pump_that_stands_or_is_set_lower_gives_nothing(name: str) -> None:
    """But its leakage, 13 lags of 30 ms later."""
    faulty = run('circuit', name)
    assert flow(faulty, 'pump')[-1] == pytest.approx(
        -0.05 * pressure(faulty, 'gallery')[-1], abs=0.01)
    assert pressure(faulty, 'stored')[-1] < pressure(run('circuit'), 'stored')[-1] - 0.5


@pytest.mark.parametrize(('name', 'lost'), [
    ('accumulator_gas_low', 0.33), ('accumulator_empty', 1.0)])
def test_lost_gas_takes_its_share_of_the_pressure(name: str, lost: float) -> None:
    """`p` falls with the amount: `(13 MPa (1 - lost) + p_a)/(13 MPa + p_a)`."""
    sound, faulty = run('circuit'), run('circuit', name)
    left = (13.0 * (1.0 - lost) * MPA + ATMOSPHERE) / (13.0 * MPA + ATMOSPHERE)
    found = faulty['station/buffer.pressure'][BEGIN + 1] + ATMOSPHERE
    before = sound['station/buffer.pressure'][BEGIN + 1] + ATMOSPHERE
    # a millisecond of the flow into it
    assert found == pytest.approx(left * before, rel=0.02, abs=0.05 * MPA)


def spilled(result: Any) -> float:
    """Return the oil that has left the press's manifold, but to the actuators, m3."""
    gone = result['station/press.returned'] - sum(
        result[f'{name}.supply_volume'] for name in ('left', 'right'))
    return float(gone[-1] - gone[BEGIN])


@pytest.mark.parametrize('name', ['supply_hose_leaks', 'manifold_leaks'])
def test_a_leaking_hose_and_a_leaking_manifold_spill_by_their_pressure(name: str) -> None:
    """0.5 l/min/MPa of the manifold, at which the hose ends."""
    faulty = run('circuit', name)
    expected = 0.5 * LEAK * faulty['station/press.pressure'][BEGIN:].sum() * 1e-3
    assert spilled(faulty) == pytest.approx(expected, rel=0.01)
    assert spilled(run('circuit')) == pytest.approx(0.0, abs=1e-3 * expected)


def test_a_torn_hose_spills_through_its_tear() -> None:
    """`0.62 0.1 A sqrt(2 P/rho)` of a bore of 16 mm."""
    faulty = run('circuit', 'supply_hose_burst')
    area = 0.1 * math.pi / 4.0 * 0.016 ** 2
    jet = 0.62 * area * np.sqrt(2.0 * np.maximum(
        0.0, faulty['station/press.pressure'][BEGIN:]) / 860.0)
    assert spilled(faulty) == pytest.approx(jet.sum() * 1e-3, rel=0.03)


@pytest.mark.parametrize(('name', 'part', 'per_mpa'), [
    ('supply_relief_leaks', 'safety', 0.5), ('dump_leaks', 'emptied', 0.5),
    ('supply_relief_stuck_open', 'safety', 60.0)])
def test_a_seat_that_does_not_close_passes_oil_by_its_drop(
        name: str, part: str, per_mpa: float) -> None:
    sound, faulty = run('circuit'), run('circuit', name)
    inside = faulty[f'station/{part}.pressure'] - faulty[f'station/{part}.return_pressure']
    assert flow(faulty, part)[BEGIN + 1:] == pytest.approx(
        per_mpa * inside[BEGIN + 1:] / MPA, rel=1e-6)
    assert np.abs(flow(sound, part)).max() == 0.0 and flow(faulty, part).max() > 5.0


def test_a_relief_valve_that_is_stuck_shut_relieves_nothing() -> None:
    """With a pump that is set to 30 MPa: a sound one opens at 23."""
    own = rig_of('circuit')
    more = [{'t_s': 0.5, 'supply': 'station', 'part': part, 'set': values} for part, values in (
        ('pump', {'pressure_mpa': 30.0, 'power_w': 1e5}),
        ('spill', {'opens_mpa': 60.0, 'shuts_mpa': 50.0}), ('kept', {'stuck_shut': 1}))]
    stuck = own.tree(fault_catalogue()['supply_relief_stuck_shut'], 0.5)
    high = [own.run.simulate(SECONDS, faults=[*more, *faults]) for faults in ((), (stuck,))]
    assert flow(high[0], 'safety')[-1] > 5.0 and pressure(high[0], 'gallery')[-1] < 24.0
    assert np.abs(flow(high[1], 'safety')).max() == 0.0
    assert pressure(high[1], 'gallery').max() > 24.5


def test_a_check_valve_stuck_shut_lets_nothing_through() -> None:
    sound, faulty = pair('check_stuck_shut')
    assert flow(sound, 'kept')[BEGIN:].max() > 20.0
    assert np.abs(flow(faulty, 'kept')[BEGIN + 1:]).max() == 0.0


def test_a_check_valve_that_does_not_close_lets_oil_back() -> None:
    """Into a gallery that an open relief valve empties; a damaged seat 2 l/min/MPa of it."""
    sound, leaking, opened = (run('circuit', 'supply_relief_stuck_open', *more) for more in (
        (), ('check_leaks',), ('check_stuck_open',)))
    at = BEGIN + 50
    assert flow(sound, 'kept')[at] == 0.0
    back = leaking['station/kept.return_pressure'] - leaking['station/kept.pressure']
    assert flow(leaking, 'kept')[at] == pytest.approx(-2.0 * back[at] / MPA, rel=1e-6)
    k = 60.0 / math.sqrt(0.5)       # l/min/sqrt(MPa)
    drop_mpa = (opened['station/kept.return_pressure'] - opened['station/kept.pressure']) / MPA
    assert flow(opened, 'kept')[at] == pytest.approx(-k * math.sqrt(drop_mpa[at]), rel=0.02)
    assert flow(opened, 'kept')[at] < -50.0


def test_a_check_valve_without_its_spring_opens_at_once() -> None:
    """At the same flow its drop is less by the 0.05 MPa of the spring."""
    sound, faulty = pair('check_spring_broken')
    k = 60.0 / math.sqrt(0.5)
    for result, spring in ((sound, 0.05), (faulty, 0.0)):
        through = flow(result, 'kept')[BEGIN + 1:]
        over = (result['station/kept.pressure'] - result['station/kept.return_pressure']) / MPA
        is_open = through > 10.0
        expected = (through[is_open] / k) ** 2 + spring
        assert is_open.sum() > 50 and over[BEGIN + 1:][is_open] == pytest.approx(
            expected, abs=0.004)


def test_an_unloading_valve_that_is_stuck_stays_and_one_that_leaks_passes_oil() -> None:
    sound, stuck = pair('unloading_stuck')
    name = 'station/spill.dump_opening'
    assert np.ptp(stuck[name][BEGIN + 1:]) == 0.0 < 0.5 < np.ptp(sound[name][BEGIN:])
    leaking = run('circuit', 'unloading_leaks')
    shut = leaking[name][BEGIN + 1:] < 1e-6
    assert shut.sum() > 10
    assert flow(leaking, 'spill')[BEGIN + 1:][shut] == pytest.approx(
        0.5 * pressure(leaking, 'gallery')[BEGIN + 1:][shut], rel=0.02)


OFF = {'t_s': 0.55, 'supply': 'station', 'set': {'dump.opened': 1}}


@pytest.mark.parametrize(('name', 'part', 'is_open'), [
    ('supply_block_stuck', 'tool_shut', 1.0), ('dump_stuck', 'emptied', 0.0)])
def test_a_stuck_valve_does_not_follow_the_emergency_stop(
        name: str, part: str, is_open: float) -> None:
    own = rig_of('circuit')
    sound = own.run.simulate(SECONDS, faults=[OFF])
    faulty = own.run.simulate(SECONDS, faults=[OFF, own.tree(fault_catalogue()[name], 0.5)])
    opening = f'station/{part}.dump_opening'
    assert faulty[opening][-1] == pytest.approx(is_open, abs=1e-9)
    assert sound[opening][-1] == pytest.approx(1.0 - is_open, abs=1e-3)


def test_a_block_valve_that_leaks_empties_what_it_shuts_off() -> None:
    own = rig_of('circuit')
    found = own.run.simulate(SECONDS, faults=[
        OFF, own.tree(fault_catalogue()['supply_block_leaks'], 0.5)])
    over = found['station/tool_shut.pressure'] - found['station/tool_shut.return_pressure']
    assert found['station/tool_shut.dump_opening'][-1] < 1e-6
    assert flow(found, 'tool_shut')[-1] == pytest.approx(0.5 * over[-1] / MPA, rel=1e-3)
    assert over[-1] < -1.0 * MPA


def test_a_clogged_filter_backs_the_return_up() -> None:
    """A tenth of 300 l/min/MPa, up to its bypass of 200 l/min/MPa at 0.35 MPa."""
    faulty = run('circuit', 'return_blocked')
    back, through = (faulty[f'station/return_filter.{name}'][BEGIN + 1:]
                     for name in ('pressure', 'pump_flow'))
    expected = 30.0 * back / MPA + 200.0 * np.maximum(0.0, back / MPA - 0.35)
    assert through / LPM == pytest.approx(expected, rel=1e-6, abs=1e-6)
    assert back.max() > 0.4 * MPA > run('circuit')['station/drain.pressure'].max()


def test_the_names_of_other_supplies_are_those_of_a_circuit() -> None:
    """Every named fault of a supply acts on a part of a circuit."""
    for name, own in fault_catalogue().items():
        if own.of == 'supply':
            assert own.part and own.part_values, name
