"""A hydraulic motor: the losses of its sheet come out again, and it turns without an end."""

from dataclasses import replace
import math

from isa_ros.actuator.actuator import SmartActuator
from isa_ros.actuator.integration import integrated, rk4_steps
from isa_ros.actuator.sheet import actuator_record, refuse_wiring
from isa_ros.core.record import row_record
from isa_ros.core.signals import COMMAND, HAS_ENABLE, HAS_QUICK_STOP, LOAD_PORT, SUPPLY_PORT
from isa_ros.core.timebase import PLANT_STEP
from isa_ros.errors import ConfigError, ParameterError
from isa_ros.plant.chambers import CHAMBERS_STATE, filling, lack_rates, volumes
from isa_ros.plant.plant import plant_record
from isa_ros.plant.sheet_fit import fits
import numpy as np
import pytest
from tests.actuator.energy import account, CLOSES, remainder
from tests.sheets import actuator_sheet, override, request, setpoint, smart_actuator

SHEET = actuator_sheet('hydraulic_motor')
MOTOR = SHEET.plant.drive
TURN = 2.0 * math.pi
RPM = TURN / 60.0
D = 15.9e-6     # m3/rad


@pytest.mark.parametrize('k', [0, 1])
def test_the_losses_are_the_efficiencies_of_both_points(k):
    """Volumetric D w/(D w + C dp) and mechanical (D dp - T)/(D dp), to what the sheet rounds."""
    losses = MOTOR.losses()
    speed, drop = MOTOR.speed_rpm[k] * RPM, MOTOR.pressure_mpa[k] * 1e6
    volumetric = D * speed / (D * speed + losses.leakage * drop)
    mechanical = 1.0 - (losses.coulomb + losses.viscous * speed) / (D * drop)
    # two leakages, 9.3 and 10.1e-13, that one number stands for: 4 % of the lost share
    assert volumetric == pytest.approx(0.01 * MOTOR.volumetric_percent[k], abs=5e-3)
    assert mechanical == pytest.approx(0.01 * MOTOR.mechanical_percent[k], rel=1e-9, abs=0.0)
    assert MOTOR.efficiencies(k) == pytest.approx((volumetric, mechanical), rel=1e-12, abs=0.0)
    shown = {one.what: (one.stated, one.model) for one in fits(SHEET.plant)}
    at = f'at 20 MPa and {MOTOR.speed_rpm[k]:g} rpm'
    assert shown[f'volumetric efficiency {at}'] == pytest.approx(
        (MOTOR.volumetric_percent[k], 100.0 * volumetric), rel=1e-12, abs=0.0)
    assert shown[f'mechanical efficiency {at}'] == pytest.approx(
        (MOTOR.mechanical_percent[k], 100.0 * mechanical), rel=1e-12, abs=0.0)


@pytest.mark.parametrize('speed', [10.0, -40.0])
def test_a_steady_shaft_loses_what_its_sheet_says(speed):
    """M6 to M8 of the kernels: the load turns it at a speed, the valve is open."""
    constants = actuator_record(SHEET, 0)
    plant = row_record(constants).plant
    port = np.zeros(1, LOAD_PORT)
    integration = integrated(port[0], np.zeros(1, SUPPLY_PORT)[0], constants[0])
    state = row_record(integration.continuous)
    port['supply_pressure'], port['v0'] = 20e6, speed
    state.supply.pressure = 20e6
    state.load.velocity = state.plant.mechanics.velocity = speed
    state.plant.chambers.p_a = state.plant.chambers.p_b = 10e6
    turned = state.load.position = state.plant.mechanics.position = 3.0
    current = math.copysign(0.006, speed)
    for _ in range(2):      # the second tenth of a second is steady
        state.totals.supply_volume = state.totals.return_volume = state.totals.impulse = 0.0
        rk4_steps(5000, PLANT_STEP, current, integration)
    own, losses = state.plant, MOTOR.losses()
    assert own.mechanics.position == pytest.approx(turned + speed * 0.2, abs=1e-2)
    drop = float(own.chambers.p_a - own.chambers.p_b)
    torque = float(state.totals.impulse) / 0.1
    rest = SHEET.plant.friction.coulomb
    expected = D * drop - math.copysign(losses.coulomb + rest, speed) - losses.viscous * speed
    assert torque == pytest.approx(expected, rel=1e-6, abs=0.0)
    # what the supply gives flows through the motor, past it, and over the two closed lands
    passed = D * speed + losses.leakage * drop
    q = float(state.totals.supply_volume) / 0.1
    leaks = [abs(passed) + plant.valve.per_root_drop * 1e-4, abs(passed)]
    assert leaks[1] < q < leaks[1] * 1.2
    assert state.totals.return_volume == pytest.approx(state.totals.supply_volume, rel=1e-6)


def test_its_chambers_neither_grow_nor_shrink():
    """M6: of any angle; what it takes from A at a density it leaves in no other volume."""
    oil = row_record(plant_record(SHEET.plant)).chambers
    for angle in (-1e4, 0.0, 3.0, 1e4):
        assert volumes(angle, oil) == pytest.approx((40e-6, 40e-6), rel=1e-12, abs=0.0)
    assert lack_rates(1e-4, -2e-4, 0.01, 0.02, 50.0, oil) == pytest.approx(
        (-1e-4 * 1.01, 2e-4 * 1.02), rel=1e-12, abs=0.0)


def test_of_what_it_displaces_it_takes_in_what_is_oil():
    """M9: by the cavity at the inlet of either direction; a piston sweeps what it sweeps."""
    oil = row_record(plant_record(SHEET.plant)).chambers
    y = row_record(np.zeros(1, CHAMBERS_STATE))
    y.cavity_a, y.cavity_b = 10e-6, 30e-6
    assert filling(y, 2.0, oil) == pytest.approx(0.75, rel=1e-12, abs=0.0)
    assert filling(y, -2.0, oil) == pytest.approx(0.25, rel=1e-12, abs=0.0)
    y.cavity_a = -1e-6      # within a step: it is compressed
    assert filling(y, 2.0, oil) == 1.0
    piston = row_record(plant_record(actuator_sheet('isa_v5').plant)).chambers
    assert filling(y, -2.0, piston) == 1.0


@pytest.mark.parametrize('speed', [30.0, -30.0])
def test_a_starved_motor_pumps_no_oil_that_it_has_not(speed):
    """
    M9: driven by its load with a valve that shuts tight, the inlet empties as exp(-D w t/V_p).

    And what turns it against the relief valve is what it still pumps.
    """
    constants = actuator_record(SHEET, 0)
    plant = constants[0]['plant']
    plant['valve']['q_0'], plant['chambers']['c_li'] = 0.0, 0.0
    plant['valve']['leak_factor'], plant['relief']['c_refill'] = 0.0, 0.0
    port = np.zeros(1, LOAD_PORT)
    integration = integrated(port[0], np.zeros(1, SUPPLY_PORT)[0], constants[0])
    state = row_record(integration.continuous)
    port['v0'] = speed
    state.load.velocity = state.plant.mechanics.velocity = speed
    empty, full = ('cavity_a', 'p_b') if speed > 0.0 else ('cavity_b', 'p_a')
    own, torques = state.plant.chambers, []
    for k in range(1, 6):
        state.totals.impulse = 0.0
        rk4_steps(5000, PLANT_STEP, 0.0, integration)
        torques.append(abs(float(state.totals.impulse)) / 0.1)
        left = 40e-6 - float(getattr(own, empty))
        assert left == pytest.approx(40e-6 * math.exp(-D * 30.0 * 0.1 * k / 40e-6), rel=0.02)
    assert float(getattr(own, full)) > 20e6     # of the relief valve
    losses = MOTOR.losses()
    least = losses.coulomb + SHEET.plant.friction.coulomb + losses.viscous * 30.0
    assert min(torques) > least and torques[-1] - least < 0.02 * (torques[0] - least)


def test_the_account_of_a_motor_with_a_cavity_closes():
    """The load turns it on behind a shut valve, hardly refilled, and then rolls back."""
    sheet = override(SHEET, 'plant.relief.refill_lpm', 0.1)
    found = smart_actuator('hydraulic_motor', 'mass', sheet=sheet, position=3.0)
    follow(found, 70.0, share=0.5)
    found.accept(request(HAS_ENABLE, 0))
    speeds, cavities = [], []
    for _ in range(3000):
        found.tick()
        speeds.append(float(found.reply.velocity))
        cavities.append((float(found.sample.cavity_a), float(found.sample.cavity_b)))
    assert max(speeds) > 17.0 and min(speeds) < -1.0
    largest = np.max(cavities, axis=0)
    assert largest[0] > 8e-6 and largest[1] > 0.5e-6
    assert remainder(account(found)) < CLOSES


def test_it_has_no_end_stop():
    own = plant_record(SHEET.plant)[0].mechanics
    assert (own.k_stop, own.d_stop) == (0.0, 0.0)


def command(kinds: int) -> np.void:
    found = np.zeros(1, COMMAND)[0]
    found['kinds'] = kinds
    return found


def follow(found: SmartActuator, target: float, share: float = 1.0) -> None:
    """Turn to a target in 6 s on a cosine, or a share of the way; 18 rad/s in its middle."""
    start, ticks = float(found.reply.position), 60000
    for k in range(round(share * ticks)):
        if k % 20 == 0:
            phase = math.pi * k / ticks
            found.accept(setpoint(
                position=start + 0.5 * (target - start) * (1.0 - math.cos(phase)),
                velocity=0.5 * (target - start) * math.sin(phase) * math.pi / 6.0))
        found.tick()


def test_it_turns_on_and_stops_where_a_stroke_would_have_ended():
    """Ten turns and more, either way, without a trip; the account closes; a stop stops there."""
    found = smart_actuator('hydraulic_motor', 'mass', sheet=SHEET, position=3.0)
    for target in (70.0, -70.0):
        follow(found, target)
        assert float(found.reply.position) == pytest.approx(target, abs=0.5)
        assert found.sample.trips == 0.0
    assert remainder(account(found)) < CLOSES
    follow(found, -140.0, share=0.5)
    assert float(found.reply.velocity) < -10.0
    found.accept(command(HAS_QUICK_STOP))
    for _ in range(5000):
        found.tick()
    assert abs(float(found.reply.velocity)) < 0.5


REFUSED = [
    ({'volumetric_percent': (90.0, 90.0)}, r'is a leakage of 9.25e-13 and of 1.39e-11 m3/s/Pa, '
     r'must agree within a factor of 2'),
    ({'volumetric_percent': (90.0, 100.0)}, r'must agree within a factor of 2'),
    ({'speed_rpm': (1000.0, 1100.0), 'volumetric_percent': (99.0, 99.0)},
     r'must differ by a factor of 1.2'),
    ({'mechanical_percent': (88.0, 92.0)}, r'a friction of 38.2 Nm at 100 rpm and of 25.4 Nm at '
     r'1500 rpm, must rise'),
    ({'mechanical_percent': (99.5, 88.0)}, r'must rise with the speed, by less than in prop'),
    ({'mechanical_percent': (92.0, 100.0)}, r'mechanical_percent\[1\] = 100 %, must be < 100 %'),
    ({'speed_rpm': (100.0,)}, r'must be a list of 2 numbers in rpm'),
    ({'speed_rpm': (1000.0, 1000.0)}, r'speed_rpm = .* rpm, must differ by a factor of 1.2')]


@pytest.mark.parametrize(('values', 'message'), REFUSED)
def test_a_sheet_that_contradicts_itself_is_refused_with_both_numbers(values, message):
    with pytest.raises(ParameterError, match=message):
        replace(MOTOR, **values)


def test_points_without_a_leakage_are_taken():
    assert replace(MOTOR, volumetric_percent=(100.0, 100.0)).losses().leakage == 0.0


def test_a_linearising_block_is_refused():
    block = actuator_sheet('isa_v5', 'default', 'feedback_linearisation').reu.force
    with pytest.raises(ConfigError, match='feedback_linearisation and plant.kind = motor'):
        refuse_wiring(override(SHEET, 'reu.force', block))
    refuse_wiring(SHEET)
