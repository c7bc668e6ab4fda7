"""How far a stop lets a load move: light, heavy, of every wiring and model, before an end."""

from typing import Any

from isa_ros.config.text.yaml_text import Tree
import pytest
from scripts.measure_stops import accelerate, ACCUMULATOR, rig, simulation_of, stop, Stopped

MOST, BOUNCE = 1.15, 3e-4
"""Of v^2/2a + v T, and back from the farthest place in m: the bounds of masses up to 50 kg."""
STIFF = {'position': 0.07, 'stiffness': 3e5, 'damping': 4000.0}
FORCE = {'mode': 'force', 'position': 0.05}


def stopped(config: Tree, speed: float, seconds: float = 0.25, **command: Any) -> Stopped:
    """Return how an actuator stops that was commanded, and has reached a speed."""
    simulation = simulation_of(config)
    simulation.command('ram', **command)
    accelerate(simulation, speed)
    return stop(simulation, seconds)


@pytest.mark.parametrize('mass', [5.0, 20.0, 50.0])
@pytest.mark.parametrize(('speed', 'position', 'command'), [
    (0.25, 0.2, STIFF), (0.4, 0.1, FORCE | {'effort': 5000.0}),
    (0.4, 0.9, FORCE | {'effort': -2000.0})], ids=['impedance', 'out', 'in'])
def test_a_light_load_stops_within_its_braking_distance(
        mass: float, speed: float, position: float, command: dict[str, Any]) -> None:
    found = stopped(rig(mass=mass, position=position), speed, **command)
    assert 0.6 < found.ratio < MOST
    assert found.bounce < BOUNCE
    assert found.swing < 50.0


HEAVY = [(0.25, 0.2, STIFF), (0.3, 0.1, FORCE | {'effort': 5000.0}),
         (0.3, 0.9, FORCE | {'effort': -2000.0})]


@pytest.mark.parametrize(('speed', 'position', 'command'), HEAVY, ids=['impedance', 'out', 'in'])
def test_a_heavy_load_is_braked_from_its_peak_speed_and_does_not_swing_back(
        speed: float, position: float, command: dict[str, Any]) -> None:
    """
    200 kg: the oil that accelerates them at the command first makes them faster.

    They swung back by 0.64 mm while the ramp ended at once.
    """
    found = stopped(rig(mass=200.0, position=position), speed, **command)
    assert found.travel < MOST * found.expected_of_peak
    assert found.bounce < BOUNCE
    assert found.swing < 50.0


@pytest.mark.parametrize(('speed', 'position', 'command'), HEAVY, ids=['impedance', 'out', 'in'])
def test_500_kg_stop_within_what_the_relief_valves_let_them_be_braked_with(
        speed: float, position: float, command: dict[str, Any]) -> None:
    """
    They need 5 kN, and the oil on one side of the piston cannot push with more than 22 MPa.

    Before that, the force that accelerates them has to reverse, for some 15 ms at their peak
    speed. At rest the oil expands that has braked them, by F/k.
    """
    simulation = simulation_of(rig(mass=500.0, position=position))
    simulation.command('ram', **command)
    accelerate(simulation, speed)
    found = stop(simulation, 0.25)
    own = simulation.group.actuators[0].memory.constants['reu']['rules']['flow'][0]
    area = own['model']['area_b' if found.speed > 0.0 else 'area_a']
    braking = min(own['deceleration'], 22e6 * area / 500.0)
    reversal = 0.015 * found.peak_speed
    assert found.travel < 1.1 * (found.peak_speed ** 2 / (2.0 * braking) + reversal)
    softest = 0.15 / (own['lag'] * own['damping'])
    assert found.bounce < 1.5 * found.peak_force / softest
    assert found.swing < 100.0


@pytest.mark.parametrize(('variant', 'command'), [
    ('valve_amplifier', {'position': 0.05, 'effort': 2e-3}),
    ('pressure_control', {'position': 0.05, 'effort': 2e6}),
    ('explicit', STIFF), ('position_control', {'position': 0.04}),
    ('feedback_linearisation', STIFF)])
def test_every_wiring_stops(variant: str, command: dict[str, float]) -> None:
    found = stopped(rig(variants=(variant,), position=0.2), 0.2, **command)
    assert found.ratio < MOST and found.bounce < BOUNCE and found.swing < 50.0


@pytest.mark.parametrize(('config', 'speed', 'command'), [
    (rig('isa_v2', position=0.1, stroke=0.08), 0.4, STIFF | {'stiffness': 2e4, 'damping': 1e3}),
    (rig('smart_manifold', load_kind='wheel', position=0.3, stroke=1.745), 1.5,
     {'position': 1.2}),
    (rig('cylinder', mass=50.0, position=0.2, stroke=0.2, supply_mpa=14.0, parameters={'plant': {
        'drive': {'bore_mm': 40.0, 'rod_mm': 25.0, 'stroke_mm': 200.0,
                  'rated_pressure_mpa': 14.0},
        'valve': {'flow': {'rated_flow_lpm': 20.0, 'rated_current_ma': 10.0}}}}), 0.15,
     {'position': 0.15}),
    (rig(supply=ACCUMULATOR, position=0.1), 0.4, FORCE | {'effort': 5000.0}),
    (rig(supply_mpa=10.0, position=0.2), 0.25, STIFF),
    (rig(variants=('data_sheet_sensors',), position=0.2), 0.25, STIFF)],
    ids=['isa_v2', 'smart_manifold', 'cylinder', 'accumulator', '10 MPa', 'noise'])
def test_every_model_and_supply_stops(
        config: Tree, speed: float, command: dict[str, Any]) -> None:
    """Where the load still accelerates at the command, the peak is what is braked."""
    found = stopped(config, speed, **command)
    assert found.travel < MOST * found.expected_of_peak and found.ratio < 1.35
    assert found.bounce < 0.02 * found.travel + BOUNCE


def test_without_protection_the_stop_knows_the_supply() -> None:
    """Its law needs the supply pressure, which no condition measures then."""
    on, off = (stopped(rig(position=0.2, parameters={'reu': {'protection': {'switch': switch}}}),
                       0.25, **STIFF) for switch in ('on', 'off'))
    assert on == off


def test_in_front_of_an_end_it_brakes_harder() -> None:
    """0.8 m/s need 38 mm at 10 m/s2; 8 mm are left: the end stop is not touched."""
    simulation = simulation_of(rig(mass=50.0, position=0.6))
    simulation.command('ram', **FORCE, effort=5000.0)
    while simulation.samples['ram'].position < 0.092:
        simulation.step()
    found = stop(simulation, 0.1)
    assert found.expected > 3 * 8e-3
    assert found.travel < 8e-3
    assert found.peak_force < 7000.0
