"""Each named fault of a part of an actuator or its load acts as its physics says, in its rig."""

import math
from typing import Any

from isa_ros.analysis.faults.rigs import ABOUT, rig_of
from isa_ros.config.models.fault_catalogue import fault_catalogue
import numpy as np
import pytest
from tests.analysis.faults.part_runs import BEGIN, LATER, LPM, MPA, pair, run

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
