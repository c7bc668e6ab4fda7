"""A single-acting cylinder: its spring, and chamber B that is open to tank or air (M5, C33)."""

from dataclasses import replace
import math

from isa_ros.actuator.ratings import forcing_areas, ratings_of
from isa_ros.actuator.sheet import actuator_record, refuse_wiring
from isa_ros.core.record import row_record, rows_of
from isa_ros.core.timebase import FASTEST_RATE, PLANT_STEP
from isa_ros.errors import ConfigError, ParameterError
from isa_ros.plant import return_spring
from isa_ros.plant.chambers import oil_stiffness
from isa_ros.plant.plant import plant_record, PLANT_STATE
from isa_ros.plant.rest_oil import rest_oil, rest_pressures
from isa_ros.plant.return_spring import CoilSpring
from isa_ros.plant.service_lines import sensed_pressures
import numpy as np
import pytest
from tests.actuator.closed_cylinder import ClosedCylinder
from tests.actuator.energy import account, CLOSES, remainder
from tests.actuator.hosed_cylinder import CHECK, COUNTERBALANCE, HOSES
from tests.sheets import actuator_sheet, override, setpoint, smart_actuator

SPRING = CoilSpring(preload=800.0, stiffness=6e3, open_to='tank')
AREA = math.pi / 4.0 * 0.040**2
ROD_SIDE = AREA - math.pi / 4.0 * 0.025**2


def single(**values):
    """Return the sheet of the model `cylinder` with a spring, rated with it as a file is."""
    sheet = override(actuator_sheet('cylinder'), 'reu.position.force_in', 2000.0)
    return override(sheet, 'plant.return_spring', replace(SPRING, **values))


def test_the_spring_pushes_in_with_its_preload_and_rate():
    own = return_spring.spring_record(SPRING)
    assert return_spring.spring_force(0.0, own) == 800.0
    assert return_spring.spring_force(0.2, own) == pytest.approx(2000.0, rel=1e-12, abs=0.0)
    assert return_spring.spring_forces(SPRING, 0.2) == pytest.approx((800.0, 2000.0))
    broken = return_spring.spring_record(replace(SPRING, broken=1.0))
    assert return_spring.spring_force(0.2, broken) == 0.0 and broken.is_on == 1.0


@pytest.mark.parametrize(('open_to', 'back', 'vent'), [('tank', 3e5, 3e5), ('breather', 3e5, 0.0)])
def test_chamber_b_has_the_pressure_of_where_it_is_open(open_to, back, vent):
    own = row_record(plant_record(single(open_to=open_to).plant))
    assert return_spring.vent_pressure(back, own.spring) == vent
    force = 3000.0
    p_a, p_b = rest_pressures(own, 14e6, back, force)
    assert p_b == vent
    assert p_a * AREA - p_b * ROD_SIDE == pytest.approx(force, rel=1e-9, abs=0.0)
    assert rest_pressures(own, 14e6, back, 1e6)[0] == 14e6
    assert rest_pressures(own, 14e6, back, -1e6)[0] == back


@pytest.mark.parametrize('position', [0.02, 0.1, 0.18])
def test_at_rest_the_oil_holds_load_and_spring_where_it_starts(position):
    """M5: A_A P_A = F + F_0 + k s + A_B P_B, so that nothing moves; hoses are as their chamber."""
    own = row_record(plant_record(override(single().plant, 'hoses', HOSES)))
    at = rows_of(1, PLANT_STATE)[0]
    at.mechanics.position = position
    rest_oil(own, 14e6, 3e5, 3000.0, at)
    pushed = at.chambers.p_a * AREA - at.chambers.p_b * ROD_SIDE
    assert pushed == pytest.approx(3000.0 + 800.0 + 6e3 * position, rel=1e-9, abs=0.0)
    # a volume of 1e-4 m3 is known to 1e-20 m3, of 1e9 Pa an elastance of 1e13 Pa/m3: 1e-6 Pa
    assert sensed_pressures(at, own) == pytest.approx(
        (at.chambers.p_a, at.chambers.p_b), rel=0.0, abs=1.0)


def test_what_an_open_chamber_gains_leaves_it_and_its_pressure_follows():
    """C33: d p/dt = r_max (vent - p); of boiling oil nothing is gained."""
    elastance, surplus = 4e13, 3e-4
    for p in (0.0, 2e5):
        out = return_spring.vented(p, 1e5, surplus, elastance)
        assert elastance * (surplus - out) == pytest.approx(
            FASTEST_RATE * (1e5 - p), rel=1e-9, abs=0.0)
    assert return_spring.vented(-1e5, 0.0, surplus, 0.0) == surplus


def test_the_lands_of_b_are_plugged_and_its_oil_is_no_spring():
    own = row_record(plant_record(single().plant))
    assert (own.valve.f_pb, own.valve.f_bt) == (0.0, 0.0)
    assert min(own.valve.f_pa, own.valve.f_at) > 0.0
    volume = float(own.chambers.dead_volume) + AREA * 0.05
    assert oil_stiffness(0.05, own.chambers) == pytest.approx(
        7e8 * AREA * AREA / volume, rel=1e-9, abs=0.0)


def test_a_free_piston_rings_at_oil_and_spring_together():
    """M5, C4: sealed A, 50 kg; 20 periods of sqrt((k_oil + k)/m) by its zero crossings."""
    stiff = replace(SPRING, preload=0.0, stiffness=2e6)
    cylinder = ClosedCylinder('cylinder', 0.1, 2e6, free=True, return_spring=stiff,
                              mechanics__inertia=50.0)
    own = cylinder.own
    own.chambers.p_b = 0.0
    own.chambers.p_a = (2e6 * 0.1) / AREA       # in balance
    own.mechanics.velocity = 1e-3
    speeds = []
    for _ in range(3000):
        cylinder.move()
        speeds.append(float(own.mechanics.velocity))
    crossings = np.flatnonzero(np.diff(np.sign(speeds)))
    period = 2.0 * (crossings[-1] - crossings[0]) / (len(crossings) - 1) * PLANT_STEP
    k_oil = 7e8 * AREA * AREA / (12.57e-6 + AREA * 0.1)
    # amplitude 5 um in 100 mm; to a step at both ends of 3000
    assert period == pytest.approx(2.0 * math.pi * math.sqrt(50.0 / (k_oil + 2e6)), rel=1e-3)
    assert float(own.chambers.p_b) == 0.0


@pytest.mark.parametrize(('open_to', 'vent'), [('tank', 2e5), ('breather', 0.0)])
def test_a_thrown_piston_stores_its_energy_in_spring_and_oil_and_sends_that_of_b_away(
        open_to, vent):
    """M5, C33, E1, E6: 50 kg at 1 m/s, against 11 kN of spring; the oil of A is sealed in."""
    cylinder = ClosedCylinder(
        'cylinder', 0.1, 14e6, free=True, mechanics__inertia=50.0,
        return_spring=replace(SPRING, stiffness=1e5, open_to=open_to))
    cylinder.port['return_pressure'] = 2e5
    own, totals = cylinder.own, cylinder.state.totals
    own.chambers.p_b, own.mechanics.velocity = vent, 1.0
    cylinder.move(40)
    moved = float(own.mechanics.position) - 0.1
    assert moved > 5e-4
    # B keeps its pressure, so that what is swept is all that leaves
    swept = -ROD_SIDE * moved if open_to == 'tank' else 0.0
    assert float(totals.return_volume) == pytest.approx(-swept, rel=1e-9, abs=0.0)
    gained = 25.0 * (float(own.mechanics.velocity) ** 2 - 1.0)
    energies = [float(totals.energies[name]) for name in totals.energies.dtype.names]
    spring = 800.0 * moved + 0.5e5 * ((0.1 + moved) ** 2 - 0.01)
    assert spring > 5.0
    # nothing boils: found within 1e-9 J
    assert sum(energies) + gained == pytest.approx(
        -2e5 * float(totals.return_volume), rel=0.0, abs=1e-6)


@pytest.mark.parametrize('open_to', ['tank', 'breather'])
def test_it_extends_by_pressure_and_comes_back_by_its_spring(open_to):
    """Oil swept by B goes to the tank and comes from there, or is air; the account closes."""
    found = smart_actuator('cylinder', 'mass', sheet=single(open_to=open_to), position=0.05)
    for position in (0.15, 0.05):
        start = float(found.reply.position)
        found.accept(setpoint(position=position))
        drawn = returned = 0.0
        for _ in range(12000):
            found.tick()
            drawn += float(found.reply.supply_volume)
            returned += float(found.reply.return_volume)
        moved = float(found.reply.position) - start
        assert moved == pytest.approx(position - start, abs=0.04)
        # all that comes goes again, but for what A gained, less what B lost to the tank; leakage
        # is in both, and the oil of A is under some MPa more: 5e-7 m3
        gained = AREA * moved - (ROD_SIDE * moved if open_to == 'tank' else 0.0)
        assert drawn - returned == pytest.approx(gained, abs=2e-6)
        assert found.sample.trips == 0.0 and found.sample.chamber_pressure_b == 0.0
    assert remainder(account(found)) < CLOSES


def test_with_a_broken_spring_it_stays_out():
    found = smart_actuator('cylinder', 'mass', sheet=single(broken=1.0), position=0.15)
    found.accept(setpoint(position=0.05))
    for _ in range(5000):
        found.tick()
    assert float(found.reply.position) > 0.14


def test_its_ratings_are_those_of_pressure_and_spring():
    own = plant_record(single().plant)[0]
    opens = float(own.relief.p_open)
    out, back = forcing_areas(own)
    assert out * opens == pytest.approx(AREA * opens - 2000.0, rel=1e-9, abs=0.0)
    assert back * opens == pytest.approx(1400.0, rel=1e-9, abs=0.0)
    plain = plant_record(actuator_sheet('cylinder').plant)[0]
    assert forcing_areas(plain) == (plain.chambers.area_a, plain.chambers.area_b)


@pytest.mark.parametrize('compensated', [0.0, 0.8])
def test_its_rated_speed_has_the_whole_pressure_over_its_one_land_and_twice_of_it(compensated):
    """20 l/min at 3.5 MPa a land, the compensated drop bounds what comes, not what goes."""
    sheet = single().plant
    own = plant_record(override(
        sheet, 'valve', replace(sheet.valve, compensated_drop_mpa=compensated)))[0]
    opens = float(own.relief.p_open)
    assert opens == pytest.approx(22e6, rel=0.2)
    assert ratings_of(own).speed == pytest.approx(
        20e-3 / 60.0 * math.sqrt(2.0 * opens / 3.5e6) / AREA, rel=1e-9, abs=0.0)


def test_a_double_acting_piston_of_its_size_is_rated_with_two_lands():
    """On the smaller area, and half of the pressure over each land: 1/sqrt(2)."""
    own, plain = (plant_record(sheet.plant)[0] for sheet in (single(), actuator_sheet('cylinder')))
    assert ratings_of(own).speed / ratings_of(plain).speed == pytest.approx(
        math.sqrt(2.0) * ROD_SIDE / AREA, rel=1e-9, abs=0.0)
    braked = override(actuator_sheet('cylinder').plant, 'valve', replace(
        actuator_sheet('cylinder').plant.valve, compensated_drop_mpa=0.8))
    assert ratings_of(plant_record(braked)[0]).speed / ratings_of(plain).speed == pytest.approx(
        math.sqrt(0.8e6 / float(plain.relief.p_open)), rel=1e-9, abs=0.0)


def test_the_reu_knows_the_sound_spring():
    """R14 takes its force into account; a broken one is told by it."""
    evidence = row_record(actuator_record(single(broken=1.0), 0)).reu.protection.evidence
    assert (evidence.preload, evidence.stiffness) == (800.0, 6e3)


def test_a_linearising_block_is_refused():
    sheet = actuator_sheet('cylinder', 'default', 'feedback_linearisation')
    refuse_wiring(sheet)
    with pytest.raises(ConfigError, match='feedback_linearisation and plant.return_spring.kind'):
        refuse_wiring(override(sheet, 'plant.return_spring', SPRING))


@pytest.mark.parametrize(('preload', 'stiffness'), [(26000.0, 100.0), (100.0, 1.3e5)])
def test_a_spring_is_refused_that_rated_pressure_does_not_push_to_the_end(preload, stiffness):
    """20.7 MPa on 1256.6 mm2 are 26012 N; 0.2 m of stroke."""
    with pytest.raises(ParameterError, match=(
            r'return_spring: preload \+ stiffness \* stroke = 26[01][20]0 N at the extended end, '
            r'must be < 26012.4 N, plant.drive.rated_pressure_mpa on')):
        refuse_wiring(single(preload=preload, stiffness=stiffness))
    refuse_wiring(single(preload=0.99 * preload, stiffness=0.99 * stiffness))


@pytest.mark.parametrize('name', ['holding_a', 'holding_b'])
@pytest.mark.parametrize('holding', [CHECK, COUNTERBALANCE], ids=['check', 'counterbalance'])
def test_a_load_holding_valve_is_refused_whose_pilot_is_not_fed(name, holding):
    hosed = override(single().plant, 'hoses', HOSES)
    with pytest.raises(ConfigError, match=(
            f'plant.{name} and plant.return_spring.kind = coil: .*; set plant.{name}.kind: none')):
        refuse_wiring(replace(single(), plant=override(hosed, name, holding)))
    refuse_wiring(replace(single(), plant=hosed))


@pytest.mark.parametrize(('name', 'value'), [
    ('preload', -1.0), ('stiffness', 2e8), ('broken', 1.01), ('broken', -0.5), ('open_to', 'sea')])
def test_ranges_are_refused_by_name(name, value):
    with pytest.raises(ParameterError, match=f'CoilSpring.{name} = '):
        replace(SPRING, **{name: value})


@pytest.mark.parametrize(('broken', 'left'), [(0.0, 1.0), (0.3, 0.7), (1.0, 0.0)])
def test_a_weak_spring_has_the_rest_of_its_force(broken, left):
    own = return_spring.spring_record(replace(SPRING, broken=broken))
    assert (own.preload, own.stiffness) == pytest.approx(
        (left * SPRING.preload, left * SPRING.stiffness), rel=1e-15, abs=0.0)
    assert own.is_on == 1.0


@pytest.mark.parametrize('p', [-1e5, 0.0, 7e6])
def test_compiled_kernels_equal_python(p):
    own = return_spring.spring_record(SPRING)
    for kernel, arguments in (
            (return_spring.spring_force, (0.123, own)), (return_spring.vent_pressure, (p, own)),
            (return_spring.vented, (p, 1e5, 3e-4, 4e13))):
        assert kernel(*arguments) == kernel.py_func(*arguments)
