"""Block valves of a whole actuator: a valve that cannot be commanded is stopped nevertheless."""

from dataclasses import replace

from isa_ros.actuator.actuator import SmartActuator
from isa_ros.actuator.sheet import refuse_wiring
from isa_ros.core.conditions import conditions
from isa_ros.core.device import DISABLED, ENABLED, FAULT
from isa_ros.core.parameter import defaults
from isa_ros.core.signals import HAS_ENABLE, HAS_QUICK_STOP
from isa_ros.errors import ConfigError
from isa_ros.loads.sheets import Mass
from isa_ros.plant.block_valve import PoppetBlock
import pytest
from tests.actuator.test_watchdog import FROZEN, moving, SOUND
from tests.sheets import actuator_sheet, override, request, setpoint, smart_actuator, TICK

HANGING = Mass(inertia=50.0, force=-3000.0)
SHIFTED = {'plant.spool.null_bias.current_ma': 2.0}
CLOSED_MS = 30      # delay and closing of the defaults


def run(found, n_ticks):
    """Advance an actuator without further commands."""
    for _ in range(n_ticks):
        found.tick()


def sheet(reaction='block', **values):
    """Return an ISA v5 with block valves; ``reaction`` to a spool that deviates for 10 ms."""
    found = actuator_sheet('isa_v5')
    found = replace(found, plant=replace(
        found.plant, block_valve=replace(defaults(PoppetBlock), **values)))
    for name, value in {'reaction': reaction, 'delay_ms': 10.0}.items():
        found = override(found, f'reu.protection.spool_deviation.{name}', value)
    return found


def actuator(own=None, load=HANGING) -> SmartActuator:
    """Return an actuator that holds its load at rest, in the middle of its stroke."""
    found = smart_actuator('isa_v5', load, timing=TICK, sheet=sheet() if own is None else own)
    found.accept(setpoint(position=0.05, effort=3000.0))
    run(found, 300)
    return found


def exact(found):
    """Return the plant's state of an actuator."""
    return found._body.plant


@pytest.mark.parametrize('fault', [SHIFTED, {'plant.spool.stuck': 1.0}], ids=['shifted', 'stuck'])
def test_a_valve_that_drives_on_is_stopped_and_carries_its_load(fault):
    """Stuck open in motion, or shifted by 2 mA at rest: at rest 150 ms after it began."""
    found = moving(sheet()) if 'plant.spool.stuck' in fault else actuator()
    found.tune(fault)
    if 'plant.spool.stuck' in fault:
        found.accept(setpoint(position=0.05))   # the reference moves, the spool does not
    run(found, 150)
    assert found.sample.device_state == FAULT
    assert conditions(found.sample.trips) == ['spool_deviation']
    assert abs(exact(found).spool.position) > 2e-5      # the spool stays open
    assert exact(found).block.lift == 0.0
    run(found, 300)
    at = float(found.sample.position)
    run(found, 300)
    assert abs(float(found.sample.position) - at) < 1e-4
    assert 0.01 < at < 0.09


def test_without_them_it_drives_on_to_the_end_of_its_stroke():
    plain = actuator(override(override(
        actuator_sheet('isa_v5'), 'reu.protection.spool_deviation.delay_ms', 10.0),
        'reu.protection.spool_deviation.reaction', 'disable'))
    plain.tune(SHIFTED)
    run(plain, 500)
    assert plain.sample.device_state == FAULT and plain.sample.position > 0.099


def test_a_disabled_actuator_sinks_by_the_leakage_of_its_piston_alone():
    """Under 3000 N by 1.5 mm/s past the lands, by 0.18 mm/s past the piston."""
    sunk = []
    for own in (actuator_sheet('isa_v5'), sheet()):
        found = actuator(own)
        found.accept(request(HAS_ENABLE, 0))
        run(found, 100)
        at = float(exact(found).mechanics.position)
        run(found, 500)
        sunk.append(at - float(exact(found).mechanics.position))
    assert 7e-4 < sunk[0] < 8e-4 and 8e-5 < sunk[1] < 1e-4


def test_it_is_enabled_again_without_a_jump():
    """The outputs wait for the lines; the load stays where it is, the current begins at zero."""
    found = actuator()
    found.accept(request(HAS_ENABLE, 0))
    run(found, 200)
    at = float(exact(found).mechanics.position)
    found.accept(request(HAS_ENABLE, 1))
    run(found, CLOSED_MS - 1)
    assert found.sample.device_state == ENABLED and found._reu.status.is_on == 0
    assert found._reu.amplifier == 0.0 and exact(found).block.lift > 0.9
    run(found, 2)
    assert found._reu.status.is_on == 1 and abs(float(found._reu.amplifier)) < 2e-4
    for _ in range(200):
        run(found, 1)
        assert abs(float(exact(found).mechanics.position) - at) < 2e-4


def test_a_quick_stop_ends_with_closed_lines():
    found = moving(sheet())
    found.accept(request(HAS_QUICK_STOP))
    run(found, 100)
    assert exact(found).block.lift == 1.0 and found._reu.status.is_stopping
    run(found, 250)
    assert found.sample.device_state == DISABLED and exact(found).block.lift == 0.0


def test_the_emergency_stop_of_one_actuator_is_a_parameter():
    found = moving(sheet(closes='by_reaction'))
    found.tune({'reu.device.emergency_stop': 1.0})
    run(found, 400)
    assert found.sample.device_state == DISABLED and exact(found).block.lift == 0.0
    assert not found.request(request(HAS_ENABLE, 1), 'enabled')[0]
    assert 'emergency stop' in found.request(request(HAS_ENABLE, 1), 'enabled')[1]
    found.tune({'reu.device.emergency_stop': 0.0})
    run(found, 1)
    assert found.request(request(HAS_ENABLE, 1), 'enabled')[0]
    run(found, 60)
    assert found.sample.device_state == ENABLED and exact(found).block.lift == 1.0


@pytest.mark.parametrize('switch', ['on', 'off'])
def test_the_watchdog_of_a_frozen_program_closes_them(switch):
    """The circuit beside the program cuts their current, with the protection off too."""
    found = moving(override(sheet(), 'reu.protection.switch', switch))
    found.tune(FROZEN)
    run(found, 60)
    assert exact(found).block.lift == 0.0 and found._reu.amplifier == 0.0
    found.tune(SOUND)
    run(found, 60)
    goes_on = switch == 'off'
    assert (exact(found).block.lift == 1.0) == goes_on
    assert found.sample.device_state == (ENABLED if goes_on else FAULT)


def test_the_emergency_stop_reaches_a_frozen_program_without_a_watchdog():
    found = moving(override(sheet(), 'reu.watchdog_ms', 0.0))
    found.tune(FROZEN | {'reu.device.emergency_stop': 1.0})
    run(found, 60)
    assert exact(found).block.lift == 0.0 and found._reu.amplifier == 0.0


def test_poppets_that_are_stuck_let_it_sink_and_hold_it_shut():
    found = actuator()
    found.tune({'plant.block_valve.stuck': 1.0})
    found.accept(request(HAS_ENABLE, 0))
    run(found, 100)
    assert exact(found).block.lift == 1.0
    found.tune({'plant.block_valve.stuck': 0.0})
    run(found, 60)
    assert exact(found).block.lift == 0.0


def test_a_snapshot_in_the_middle_of_their_motion_continues_byte_for_byte():
    found, twin = (moving(sheet()) for _ in 'ab')
    for own in (found, twin):
        own.accept(request(HAS_ENABLE, 0))
        run(own, 20)
    assert 0.0 < exact(found).block.lift < 1.0
    other = smart_actuator('isa_v5', 'mass', timing=TICK, sheet=sheet())
    other.restore(found.snapshot())
    for own in (other, twin):
        run(own, 50)
        own.accept(request(HAS_ENABLE, 1))
        run(own, 20)
    assert 0.0 < exact(other).block.lift < 1.0
    assert other.snapshot() == twin.snapshot() != found.snapshot()


def test_the_energy_account_closes_over_closing_and_opening_lines():
    """E1 is the sum of all shares; those of the poppets are throttling."""
    found = moving(sheet())
    for enable in (0, 1):
        found.accept(request(HAS_ENABLE, enable))
        run(found, 100)
    sample = found.sample
    shares = ('leakage', 'throttling', 'cross_port', 'relief', 'friction', 'damping', 'stored')
    total = sum(float(sample[f'{name}_energy']) for name in shares) + float(sample.work)
    # Simpson's rule over steps in which a lift begins to move: 1e-3 of what flowed through
    assert total == pytest.approx(float(sample.hydraulic_energy), rel=1e-3, abs=0.0)


@pytest.mark.parametrize(('key', 'named'), [
    ('spool_deviation.reaction', 'reu.protection.spool_deviation.reaction'),
    ('link_lost_reaction', 'reu.protection.link_lost_reaction')])
def test_the_reaction_block_needs_block_valves(key, named):
    own = override(actuator_sheet('isa_v5'), f'reu.protection.{key}', 'block')
    with pytest.raises(ConfigError, match=f'{named} = block: there are no block valves'):
        refuse_wiring(own)
    refuse_wiring(replace(own, plant=sheet().plant))
