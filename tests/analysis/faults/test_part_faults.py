"""Each named fault of a part acts as its physics says, in the rig of `isa faults` that has it."""

from functools import cache
import math
from typing import Any

from isa_ros.analysis.faults.rigs import ABOUT, rig_of
from isa_ros.config.models.fault_catalogue import fault_catalogue
import numpy as np
import pytest

ATMOSPHERE, LPM, MPA = 101325.0, 1e-3 / 60.0, 1e6
BEGIN, LATER = 500, 740     # ticks of 1 ms: of the fault, and before the end of a run
SECONDS = 0.9
LEAK = LPM / MPA            # 1 l/min/MPa


@cache
def run(rig: str, *faults: str, seconds: float = SECONDS, begin: float = 0.5) -> Any:
    """Return the result of a rig with named faults from a time on, 0.5 s."""
    own = rig_of(rig)
    return own.run.simulate(
        seconds, faults=[own.tree(fault_catalogue()[name], begin) for name in faults])


def pair(name: str, seconds: float = SECONDS) -> tuple[Any, Any]:
    """Return the results without and with a fault, in its rig."""
    rig = fault_catalogue()[name].rig
    return run(rig, seconds=seconds), run(rig, name, seconds=seconds)


pytestmark = pytest.mark.filterwarnings('ignore::isa_ros.TripWarning')


def test_every_rig_of_the_catalogue_is_there() -> None:
    assert {own.rig for own in fault_catalogue().values()} - {''} == set(ABOUT)


def speed(result: Any, first: int, last: int) -> float:
    """Return the mean speed of the slide between two ticks, mm/s."""
    position = result['slide.position']
    return float(position[last] - position[first]) * 1e6 / (last - first)


@pytest.mark.parametrize(('end', 'swing'), [('a', 0.15), ('b', 0.03)])
def test_a_blocked_restriction_lets_the_slide_creep(end: str, swing: float) -> None:
    """
    A quarter of the flow at the same pressure drop: a quarter of the speed, Q = K sqrt(dp).

    At the cap side the slide still swings by 0.08 mm of the 0.58 mm that it creeps.
    """
    sound, faulty = pair(f'cushion_{end}_blocked')
    ratio = speed(faulty, 600, LATER) / speed(sound, 600, LATER)
    assert ratio == pytest.approx(0.25, rel=swing)


@pytest.mark.parametrize(('end', 'sign'), [('a', -1.0), ('b', 1.0)])
def test_a_check_valve_stuck_open_brakes_nothing(end: str, sign: float) -> None:
    """The slide reaches the end with a good part of its speed before the cushion."""
    sound, faulty = pair(f'cushion_{end}_check_stuck_open')
    depth = sign * (faulty['slide.position'] - sound['slide.position'])[LATER]
    assert 0.010 < depth < 0.025
    assert np.abs(faulty['slide.force']).max() > 1.5 * np.abs(sound['slide.force']).max()
    at_end = 250.0 if end == 'b' else 0.0
    assert abs(faulty['slide.position'][LATER] * 1e3 - at_end) < 1.0


@pytest.mark.parametrize('end', ['a', 'b'])
def test_a_check_valve_stuck_shut_lets_no_oil_back(end: str) -> None:
    """On the way out the pressure of the port does not reach the spear, and the slide is late."""
    sound, faulty = pair(f'cushion_{end}_check_stuck_shut', 1.0)
    drops = []
    for result in (sound, faulty):
        trapped = result['slide.cushion_pressure']
        over = result[f'slide.chamber_pressure_{end}'] - trapped
        drops.append(over[760:][trapped[760:] != 0.0].max())
    assert drops[0] < 4.0 * MPA < 10.0 * MPA < drops[1]
    late = abs((sound['slide.position'] - faulty['slide.position'])[860])
    assert late > 0.004


@pytest.mark.parametrize(('name', 'share'), [
    ('return_spring_weak', 0.5), ('return_spring_broken', 1.0)])
def test_the_oil_carries_what_the_spring_no_longer_pulls(name: str, share: float) -> None:
    """`(600 N + 4 kN/m s) share`, while the table sinks, so that its seals rub the same way."""
    sound, faulty = run('return_spring'), run('return_spring', name, begin=0.1)
    area = math.pi / 4.0 * 0.05 ** 2
    carried = [float((area * own['table.pressure_a'] - own['table.force'])[160:240].mean())
               for own in (sound, faulty)]
    spring = 600.0 + 4e3 * float(faulty['table.position'][160:240].mean())
    # of the load cell a code is 16 N
    assert carried[0] - carried[1] == pytest.approx(share * spring, rel=0.02, abs=16.0)


@pytest.mark.parametrize('side', ['a', 'b'])
def test_a_burst_hose_is_empty(side: str) -> None:
    """The load falls onto its stop without the oil of A; without that of B it stays up."""
    sound, faulty = pair(f'hose_{side}_burst')
    assert faulty[f'boom.pressure_{side}'][600:].max() < 0.1 * sound[
        f'boom.pressure_{side}'][600:].mean()
    fall = (sound['boom.position'] - faulty['boom.position'])[-1]
    assert (fall > 0.15) if side == 'a' else (abs(fall) < 0.02)


@pytest.mark.parametrize('side', ['a', 'b'])
def test_a_leaking_hose_loses_energy_to_the_outside(side: str) -> None:
    """The integral of `1e-11 m3/s/Pa p^2` with the pressure of the hose, and its oil is gone."""
    sound, faulty = pair(f'hose_{side}_leaks')
    lost, usual = (float(own['boom.cross_port_energy'][-1] - own['boom.cross_port_energy'][BEGIN])
                   for own in (faulty, sound))
    expected = 1e-11 * (faulty[f'boom.pressure_{side}'][BEGIN:] ** 2).sum() * 1e-3
    assert lost - usual == pytest.approx(expected, rel=0.01)
    gone = [own['boom.supply_volume'] - own['boom.return_volume'] for own in (sound, faulty)]
    assert (gone[1] - gone[0])[-1] > 1e-5


def drop(result: Any, side: str) -> Any:
    """Return the drop over a load-holding valve, Pa."""
    return result[f'boom.chamber_pressure_{side}'] - result[f'boom.pressure_{side}']


@pytest.mark.parametrize('side', ['a', 'b'])
@pytest.mark.parametrize('fault', ['stuck_open', 'spring_broken'])
def test_a_valve_that_does_not_hold_throttles_nothing(side: str, fault: str) -> None:
    """What leaves the chamber drops to the line by no more than through the open poppet."""
    sound, faulty = pair(f'holding_{side}_{fault}', 1.0)
    assert drop(faulty, side)[BEGIN:].max() < 0.6 * drop(sound, side)[BEGIN:].max()


def test_a_load_falls_where_hose_and_valve_fail() -> None:
    """Of a torn hose the valve holds it; stuck open or without its spring it does not."""
    held = run('holding', 'hose_a_burst')['boom.position']
    for fault in ('stuck_open', 'spring_broken'):
        fallen = run('holding', 'hose_a_burst', f'holding_a_{fault}')['boom.position']
        assert held[BEGIN] - held[-1] < 0.03 < 0.1 < fallen[BEGIN] - fallen[-1]


def test_a_damaged_seat_lets_the_load_sink() -> None:
    """`K sqrt(p)` of 2 l/min at 21 MPa, under the load of 12 kN on a piston of 50 mm."""
    sinking = run('holding', 'hose_a_burst', 'holding_a_leaks', seconds=1.0)
    speed_down = float(sinking['boom.position'][800] - sinking['boom.position'][950]) / 0.15
    inside = sinking['boom.chamber_pressure_a'] - sinking['boom.pressure_a']
    expected = 2.0 * LPM * math.sqrt(inside[800:950].mean() / 21e6) / (math.pi / 4.0 * 0.05 ** 2)
    assert speed_down == pytest.approx(expected, rel=0.1)


@pytest.mark.parametrize(('side', 'sign'), [('a', -1.0), ('b', 1.0)])
def test_a_valve_stuck_shut_lets_the_piston_go_one_way_only(side: str, sign: float) -> None:
    """Shut at A it does not come down, shut at B not up, but for what the oil gives way."""
    sound, faulty = pair(f'holding_{side}_stuck_shut', 1.0)
    for result, least, most in ((sound, 0.03, 0.07), (faulty, 0.0, 0.0065)):
        position = sign * result['boom.position'][BEGIN + 30:]
        assert least < (position - np.minimum.accumulate(position)).max() < most


def test_stuck_block_valves_do_not_hold_a_load() -> None:
    """Off at 0.55 s with a null that is shifted: sound ones shut, past jammed ones oil flows."""
    own = rig_of('block_valves')
    more = [{'t_s': 0.5, 'actuator': 'ram', 'fault': 'null_shift',
             'set': {'plant.spool.null_bias.current_ma': 1.0}},
            {'t_s': 0.55, 'actuator': 'ram', 'set': {'reu.device.emergency_stop': 1}}]
    stuck = own.tree(fault_catalogue()['block_valves_stuck'], 0.5)
    held, fallen = (own.run.simulate(1.0, faults=[*more, *faults])['ram.position']
                    for faults in ((), (stuck,)))
    assert abs(held[900] - held[660]) < 2e-4 < 5e-3 < fallen[900] - fallen[660]


@pytest.mark.parametrize(('name', 'amplitude'), [
    ('hysteresis_grown', 0.02), ('threshold_grown', 0.002)])
def test_the_loop_of_the_valve_is_wider(name: str, amplitude: float) -> None:
    """Spool over current on the way up and down: a threshold widens the loops of small motions."""
    def width(result: Any) -> float:
        current, spool = result['ram.current'][-2000:], result['ram.spool'][-2000:]
        gain = np.polyfit(current, spool, 1)[0]
        error = current - spool / gain
        rises = np.gradient(np.convolve(current, np.ones(9) / 9.0, 'same')) > 0.0
        return float(error[rises].mean() - error[~rises].mean())
    own = rig_of('hysteresis')
    slow = own.run.replace({'scenario.tracks.ram[0].sine': {
        'amplitude': amplitude, 'frequency_hz': 0.5}})
    fault = own.tree(fault_catalogue()[name], 0.5)
    sound, faulty = (width(slow.simulate(2.5, faults=faults)) for faults in ((), (fault,)))
    assert faulty > 1.3 * sound > 0.0


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
