"""An own cylinder and servo valve from ten lines: what their data sheets say comes out again."""

from collections.abc import Callable, Mapping
import math
from pathlib import Path

from isa_ros.actuator.actuator import SmartActuator
from isa_ros.config.runs.run_config import RunConfig
from isa_ros.config.runs.run_file import load_run
from isa_ros.plant import servo_valve
from isa_ros.plant.chambers import hydraulic_force
from isa_ros.plant.plant import plant_record
from isa_ros.scripting.result import Result
import isa_ros.scripting.run as scripting
import numpy as np
import pytest
from tests.sheets import FINE, setpoint

FILE = """
name: own
step_ms: 1.0
controller_offset_ms: 0.12
tick_timeout_s: 5.0
supply: {kind: constant, pressure_mpa: 14.0, return_pressure_mpa: 0.0}
actuators:
  ram:
    model: cylinder
    load: {kind: %s}
    %s
    parameters:
      plant:
        drive: {bore_mm: %g, rod_mm: %g, stroke_mm: %g, rated_pressure_mpa: 14.0}
        valve: {flow: {rated_flow_lpm: %g, rated_current_ma: 10.0}}
"""
RATED = 20.0 / 60e3  # m3/s at 7 MPa
SIZES = {'16/12': (16.0, 12.0, 80.0, 5.0), '40/25': (40.0, 25.0, 200.0, 20.0),
         '63/45': (63.0, 45.0, 300.0, 60.0),
         '320/220': (320.0, 220.0, 4000.0, 1000.0)}     # of a crane
AREA = math.pi / 4.0 * 0.040 * 0.040
ROD_SIDE = AREA - math.pi / 4.0 * 0.025 * 0.025
SUPPLY = 14e6

Own = Callable[..., Path]


@pytest.fixture
def own(tmp_path: Path) -> Own:
    """Return a function that writes the file of an own cylinder."""
    def written(load: str = 'blocked', variant: str = '', size: str = '40/25',
                more: str = '') -> Path:
        path = tmp_path / 'own.yaml'
        path.write_text(FILE % (
            load, f'variants: [{variant}]' if variant else '', *SIZES[size]) + more)
        return path
    return written


def simulated(
        path: Path, duration: float, steps: list[Mapping[str, object]], **keys: str) -> Result:
    """Return the result of a run with setpoints of the ram, and further keys of the scenario."""
    scenario = {'name': 'own', 'duration_s': duration, 'tracks': {'ram': steps}, **keys}
    return scripting.load(path, scenario).simulate()


def limp(t: float, effort: float) -> dict[str, object]:
    """Return a setpoint that is a force alone."""
    return {'t_s': t, 'position': 'hold', 'stiffness': 0.0, 'damping': 0.0, 'effort': effort}


@pytest.mark.parametrize(('sign', 'area'), [(1.0, AREA), (-1.0, ROD_SIDE)])
def test_it_pushes_and_pulls_with_its_areas(own: Own, sign: float, area: float) -> None:
    """C3: at full command one chamber has P_S and the other P_T; the limits are A P_S."""
    path = own()
    result = simulated(path, 0.6, [limp(0.0, sign * 1e5)], beyond_range='accept')
    stall = area * SUPPLY
    # the tail of the last millimetre at a small drop, the converter's 4 kPa on 14 MPa
    pressures = [result[f'ram.pressure_{side}'][-1] for side in 'ab']
    plant = plant_record(load_run(path).actuators[0].sheet.plant)[0]
    assert sign * hydraulic_force(*pressures, plant.chambers) == pytest.approx(stall, rel=5e-3)
    # the load cell lacks at most the Coulomb friction, 1.25 % of A_A P_S
    assert 0.0 <= stall - sign * result['ram.force'][-1] <= 0.0135 * AREA * SUPPLY + 0.005 * stall


def valve_of(path: Path) -> np.record:
    """Return the `VALVE` record of the only actuator of a run file."""
    return plant_record(load_run(path).actuators[0].sheet.plant)[0].valve


@pytest.mark.parametrize('size', SIZES)
def test_the_rated_flow_crosses_at_the_rated_drop(own: Own, size: str) -> None:
    """7 MPa over both lands at 10 mA, within 1 % of the data sheet."""
    path = own(size=size)
    valve = valve_of(path)
    x = 10e-3 * valve.k_spool
    q_a, q_b, _, _ = servo_valve.port_flows(x, 3.5e6, 3.5e6, 7e6, 0.0, valve)
    rated = SIZES[size][3] / 60e3
    assert (q_a, -q_b) == pytest.approx((rated, rated), rel=0.01, abs=0.0)


def test_it_moves_as_fast_as_the_rated_flow_lets_it(own: Own) -> None:
    """At full current v A_A = Q_r sqrt((P_S - P_A)/3.5 MPa): the whole run, within 1 %."""
    path = own('mass, inertia: 5.0', 'valve_amplifier')
    result = simulated(path, 0.2, [{'t_s': 0.0, 'position': 'hold', 'effort': 0.01}])
    late = slice(100, 180)
    speed = np.diff(result['ram.position'])[late].mean() / 1e-3
    drop = SUPPLY - result['ram.pressure_a'][late].mean()
    assert speed * AREA == pytest.approx(RATED * math.sqrt(drop / 3.5e6), rel=0.01)


def test_at_null_it_leaks_what_the_data_sheet_says(own: Own) -> None:
    """The model's 1 l/min at 20.7 MPa, 5 % of the rated flow, at 14 MPa: by its square root."""
    path = own('blocked', 'valve_amplifier')
    result = simulated(path, 3.0, [{'t_s': 0.0, 'position': 'hold', 'effort': 0.0}])
    leaked = result['ram.supply_flow'][-200:].mean() * 60e3
    # 3 s are ten time constants of the chambers; the orifices' smoothing is 5e-5 at 7 MPa
    assert leaked == pytest.approx(math.sqrt(14.0 / 20.7), rel=1e-3)


def amplitude(values: list[float], phase: np.ndarray) -> float:
    """Return the amplitude of a sine in values over whole periods."""
    return 2.0 * abs(np.mean(np.array(values) * np.exp(-1j * phase)))


def test_the_spool_has_its_bandwidth(own: Own) -> None:
    """-3 dB at the stated 100 Hz, from the coil's current to the spool."""
    path = own('blocked', 'valve_amplifier',
               more='        spool: {at: minus_3_db, frequency_hz: 100.0}\n')
    run: RunConfig = load_run(path)
    ram = SmartActuator(run.actuators[0], FINE)
    ram.start(run.actuators[0].initial_position, 0.0, SUPPLY, 0.0)
    spools, currents, phases = [], [], []
    for k in range(800):  # 8 periods; the first 4, 25 time constants, are left out
        phase = 2.0 * math.pi * 100.0 * k * 1e-4
        ram.accept(setpoint(effort=2e-3 * math.sin(phase)))
        ram.tick()
        if k >= 400:
            spools.append(ram.sample['spool'])
            currents.append(ram.sample['current'])
            phases.append(phase)
    ratio = amplitude(spools, np.array(phases)) / amplitude(currents, np.array(phases))
    # 400 readings of a 12-bit converter: 1e-3 of 2 of 12.5 mA
    assert ratio / valve_of(path).k_spool == pytest.approx(math.sqrt(0.5), rel=3e-3)


@pytest.mark.parametrize('place', [0.05, 0.5, 0.95])
@pytest.mark.parametrize('size', SIZES)
def test_its_force_steps_and_rests_quietly(own: Own, size: str, place: float) -> None:
    """0.3 A_A P_S within 1 % after 0.25 s, at most 20 % beyond, then a ripple below 0.2 %."""
    bore, _, stroke, _ = SIZES[size]
    path = own(size=size)
    path.write_text(path.read_text().replace(
        'model: cylinder', f'model: cylinder\n    initial_position_mm: {place * stroke:g}'))
    stall = math.pi / 4.0 * (bore * 1e-3) ** 2 * SUPPLY
    force = simulated(path, 0.5, [limp(0.0, 0.0), limp(0.2, 0.3 * stall)])['ram.force'] / stall
    assert force[150:200].std() < 0.002
    assert 0.3 < force[200:].max() < 0.36
    assert force[-50:].mean() == pytest.approx(0.3, abs=0.003)
    assert force[-50:].std() < 0.002


@pytest.mark.parametrize('size', SIZES)
def test_its_impedance_steps_and_rests_quietly(own: Own, size: str) -> None:
    """3 % of the stroke with a free mass: there within a tenth of it after 1 s, and quiet."""
    stroke = SIZES[size][2] * 1e-3
    result = simulated(own('mass', size=size), 1.3, [
        {'t_s': 0.0, 'position': 'hold'}, {'t_s': 0.1, 'position': 0.53 * stroke}])
    moved = (result['ram.position'] - 0.5 * stroke) / (0.03 * stroke)
    assert moved.max() < 1.25
    assert moved[-1] == pytest.approx(1.0, abs=0.1)
    stall = math.pi / 4.0 * (SIZES[size][0] * 1e-3) ** 2 * SUPPLY
    assert result['ram.force'][-100:].std() < 0.002 * stall


def test_the_largest_cylinder_that_is_declared_has_its_scaled_values(own: Own) -> None:
    """500/360 x 5000 mm at 70 MPa, 1000 l/min: no value that scales is beyond its range."""
    path = own()
    path.write_text(path.read_text().replace(
        'bore_mm: 40, rod_mm: 25, stroke_mm: 200, rated_pressure_mpa: 14.0',
        'bore_mm: 500, rod_mm: 360, stroke_mm: 5000, rated_pressure_mpa: 70.0').replace(
        'rated_flow_lpm: 20', 'rated_flow_lpm: 1000'))
    sheet = load_run(path).actuators[0].sheet
    swept = sheet.plant.drive.areas[0] * sheet.plant.drive.stroke
    assert swept == pytest.approx(0.9817, rel=1e-4, abs=0.0)
    assert sheet.plant.oil.dead_volume_ml * 1e-6 == pytest.approx(0.05 * swept, rel=1e-3, abs=0.0)


def test_the_shipped_example_is_as_long_as_it_says() -> None:
    """`config/rig_cylinder.yaml`: ten lines below the times of the run."""
    path = Path(__file__).parents[1] / 'config' / 'rig_cylinder.yaml'
    lines = [line for line in path.read_text().splitlines()
             if line.strip() and not line.startswith(('#', 'step_', 'controller_', 'tick_'))]
    assert len(lines) <= 10
    assert load_run(path).actuators[0].sheet.plant.drive.bore_mm == 40.0
