"""Values of a model follow the rated data of a run file and nothing else; its own values win."""

from collections.abc import Callable, Iterator
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import isa_ros
from isa_ros.actuator.scales import SCALES
from isa_ros.actuator.sheet import ActuatorSheet
from isa_ros.config.listing import describe
from isa_ros.config.models import scaling
from isa_ros.config.models.catalogue import actuator_model, model_names
from isa_ros.config.runs.default_actuator import default_actuator
from isa_ros.config.runs.run_config import RunConfig
from isa_ros.config.runs.run_reading import run_of, run_of_text
from isa_ros.config.text.parameter_sets import build
from isa_ros.config.text.sections import Place
from isa_ros.config.text.yaml_text import parse
from isa_ros.core.parameter import Parameters
from isa_ros.errors import ConfigError
import pytest

Quantity = Callable[[ActuatorSheet], float]

HEAD = """
name: own
step_ms: 1.0
controller_offset_ms: 0.12
tick_timeout_s: 5.0
supply: {kind: constant, pressure_mpa: %g, return_pressure_mpa: 0.0}
actuators:
  ram:
    model: %s
    load: {kind: %s}
    parameters:
"""
OWN = '      plant: {drive: {bore_mm: 40.0, rod_mm: 25.0, rated_pressure_mpa: 14.0}}\n'
MOTOR = """
      plant:
        drive:
          displacement_cc_per_rad: 15.9
          pressure_mpa: [20.0, 20.0]
          speed_rpm: [100.0, 1500.0]
          volumetric_percent: [90.0, 99.2]
          mechanical_percent: [92.0, 88.0]
          rated_pressure_mpa: 20.7
        valve: {flow: {rated_flow_lpm: 40.0, rated_current_ma: 10.0}}
"""
CYLINDER = """
      plant:
        drive: {bore_mm: 40.0, rod_mm: 25.0, stroke_mm: 200.0, rated_pressure_mpa: 20.7}
        valve: {flow: {rated_flow_lpm: 20.0, rated_current_ma: 10.0}}
"""
A_A, A_B = 1256.637e-6, 765.763e-6  # m2, of 40/25 mm
ISA_A, ISA_B = 363.050e-6, 249.953e-6  # m2, of 21.5/12 mm
ROUNDED = 1e-5  # of the areas above
TWO_LINES = """
        valve:
          kind: data_sheet
          rated_drop_mpa: 7.0
          spool_travel_mm: 0.2
          flow: {kind: points, current_ma: [0, 2, 10], flow_lpm: [0, 2, 18]}
          leakage: {pressure_mpa: 14.0, current_ma: [0], total_lpm: [0.2], tare_lpm: 0.1}
          orifice_smoothing_kpa: 100.0
          slots: matched
          lap: {pa_um: 0.0, at_um: 0.0, bt_um: 0.0, pb_um: 0.0}
"""


def own(parameters: str = OWN, model: str = 'isa_v5', supply: float = 14.0,
        load: str = 'mass') -> RunConfig:
    """Return a run with one actuator of a model, changed by ``parameters``."""
    text = HEAD % (supply, model, load) + parameters
    return run_of(parse(text, 'own.yaml'), Place('own.yaml'))[0]


def sheet_of(run: RunConfig) -> ActuatorSheet:
    """Return the sheet of the only actuator."""
    return run.actuators[0].sheet


def test_a_larger_bore_in_the_isa_s_model_has_its_own_ratings() -> None:
    """The ISA v5's ratings, 7500 and 5174 N at 20.7 MPa, for other areas and 14 MPa."""
    sheet, isa = sheet_of(own()), default_actuator('isa_v5', 'isa').sheet
    position = sheet.reu.position
    assert position.force_out == pytest.approx(
        7500.0 * A_A / ISA_A * 14.0 / 20.7, rel=ROUNDED, abs=0.0)
    assert position.force_in == pytest.approx(
        5174.0 * A_B / ISA_B * 14.0 / 20.7, rel=ROUNDED, abs=0.0)
    assert position.force_in == pytest.approx(A_B * 14e6, rel=1e-4, abs=0.0)  # 5174 is rounded
    for part, name, factor in (
            ('sensors', 'force_range', A_A / ISA_A),
            ('friction', 'coulomb', A_A / ISA_A),
            ('mechanics', 'stop_stiffness', A_A / ISA_A),
            ('oil', 'cross_port_leakage', 40.0 / 21.5)):
        value, before = (getattr(getattr(of.plant, part), name) for of in (sheet, isa))
        assert value == pytest.approx(before * factor, rel=ROUNDED, abs=0.0)
    assert sheet.plant.valve == isa.plant.valve
    force = sheet.reu.force
    assert replace(force, kp=isa.reu.force.kp, ki=isa.reu.force.ki) == isa.reu.force


def two_rods(cap_rod_mm: float, more: str = '') -> ActuatorSheet:
    """Return the sheet of a cylinder of 63/36 x 400 mm with a second rod."""
    return sheet_of(own(f"""
      plant:
        drive: {{bore_mm: 63.0, rod_mm: 36.0, cap_rod_mm: {cap_rod_mm}, stroke_mm: 400.0,
                rated_pressure_mpa: 16.0}}
        valve: {{flow: {{rated_flow_lpm: 20.0, rated_current_ma: 10.0}}}}{more}
""", 'cylinder'))


@pytest.mark.parametrize('cap_rod_mm', [10.0, 36.0, 40.0, 62.0])
def test_a_second_rod_adds_its_mass_and_leaves_the_piston_its_bore(cap_rod_mm: float) -> None:
    """Mass as the piston's and both rods' volume: pi/4 (D^3 + 2 L (d^2 + d_2^2))."""
    one, two = two_rods(0.0).plant, two_rods(cap_rod_mm).plant
    rod, both = (0.063**3 + 0.8 * (0.036**2 + cap * cap) for cap in (0.0, cap_rod_mm * 1e-3))
    # a few roundings
    assert two.mechanics.inertia / one.mechanics.inertia == pytest.approx(
        both / rod, rel=1e-12, abs=0.0)
    assert two.oil.cross_port_leakage == one.oil.cross_port_leakage


@pytest.mark.parametrize('cap_rod_mm', [0.0, 36.0, 50.0])
def test_a_spear_of_the_cap_side_fits_between_second_rod_and_bore(cap_rod_mm: float) -> None:
    cushioned = '\n      reu: {}\n    variants: [cushioned]'
    plant = two_rods(cap_rod_mm, cushioned).plant
    assert plant.cushion_a.spear_mm == pytest.approx(
        0.5 * (63.0 + cap_rod_mm), rel=1e-12, abs=0.0)
    assert plant.cushion_a.entry_mm == pytest.approx(6.3, rel=1e-12, abs=0.0)


def leaves(parameters: Parameters, prefix: str = '') -> Iterator[tuple[str, Any]]:
    """Yield the dotted key and the value of every parameter of a set."""
    for f in fields(parameters):
        value = getattr(parameters, f.name)
        if isinstance(value, Parameters):
            yield from leaves(value, f'{prefix}{f.name}.')
        else:
            yield f'{prefix}{f.name}', value


CHANGES = [
    'plant.oil.effective_bulk_modulus', 'plant.oil.dead_volume_ml', 'plant.friction.coulomb',
    'plant.mechanics.sensor_stiffness', 'plant.mechanics.inertia', 'plant.sensors.force_range',
    'plant.relief.opening_pressure_mpa', 'reu.force.rate_hz', 'reu.current.rate_hz',
    'reu.speed.rate_hz', 'reu.position.stiffness']


@pytest.mark.parametrize('file', ['rig_cylinder', 'rig_linear', 'leg'])
@pytest.mark.parametrize('key', CHANGES)
def test_a_changed_value_changes_nothing_else(file: str, key: str) -> None:
    """A sweep of oil, load cell, friction or a rate is of one and the same actuator."""
    run = isa_ros.load(file)
    actuator = run.configuration.actuators[0]
    before = dict(leaves(actuator.sheet))
    factor = {'reu.current.rate_hz': 0.5}.get(key, 0.2 if key.endswith('rate_hz') else 1.01)
    other = run.replace({f'actuators.{actuator.name}.parameters.{key}': before[key] * factor})
    changed = other.configuration.actuators[0]
    assert dict(leaves(changed.sheet)) == before | {key: before[key] * factor}
    assert changed.load == actuator.load


@pytest.mark.parametrize('file', ['rig_cylinder', 'leg'])
def test_the_supply_of_a_run_changes_nothing_of_its_actuators(file: str) -> None:
    run = isa_ros.load(file)
    other = run.replace({'supply.pressure_mpa': 9.0, 'supply.return_pressure_mpa': 0.5})
    assert other.configuration.actuators == run.configuration.actuators
    assert other.configuration.supplies != run.configuration.supplies


def test_what_follows_rated_data_does_not_depend_on_other_changes() -> None:
    """A bore changed together with oil and load cell has the gains of that bore."""
    oil = """
        oil: {effective_bulk_modulus: 1.4e+9}
        mechanics: {sensor_stiffness: 9.0e+7}
"""
    plain, both = (sheet_of(own('      plant:\n        drive: {bore_mm: 40.0}\n' + more))
                   for more in ('', oil.lstrip('\n')))
    assert both.reu == plain.reu
    assert plain.reu.force.kp != default_actuator('isa_v5', 'isa').sheet.reu.force.kp


@pytest.mark.parametrize(('drive', 'flow', 'message'), [
    ('{bore_mm: 40.0, rod_mm: 25.0, rated_pressure_mpa: 14.0}',
     '{rated_flow_lpm: 20.0, rated_current_ma: 10.0}',
     'lacks plant.drive.stroke_mm: cylinder has'),
    ('{bore_mm: 40.0, rod_mm: 25.0, stroke_mm: 200.0}', '{rated_flow_lpm: 20.0}',
     'lacks plant.drive.rated_pressure_mpa, plant.valve.flow.rated_current_ma: cylinder has'),
])
def test_a_number_of_the_data_sheets_is_not_assumed(drive: str, flow: str, message: str) -> None:
    """A stroke of 200 mm and 10 mA are those of the model, not of the user's cylinder."""
    text = f'      plant: {{drive: {drive}, valve: {{flow: {flow}}}}}\n'
    with pytest.raises(ConfigError, match=f'own.yaml: actuators.ram.parameters {message}'):
        own(text, 'cylinder')


def test_limit_and_compensation_follow_a_valve_of_two_lines() -> None:
    """V15: to 2 of 10 mA 1 l/min/mA, then 2; 0.2 mm of spool at 10 mA."""
    force = sheet_of(own('      plant:' + TWO_LINES)).reu.force
    assert force.limit == pytest.approx(2e-4, rel=1e-12, abs=0.0)
    assert force.compensation.knee == pytest.approx(0.4e-4, rel=1e-12, abs=0.0)
    # 0.16 is the ISA's 0.4 over 2.5
    assert force.compensation.slope == pytest.approx(0.5, rel=1e-12, abs=0.0)


def test_a_value_of_the_run_file_is_not_scaled() -> None:
    changed = OWN + '      reu: {position: {force_in: 1000.0}}\n'
    position = sheet_of(own(changed)).reu.position
    assert position.force_in == 1000.0
    assert position.force_out == sheet_of(own()).reu.position.force_out


@pytest.mark.parametrize('name', model_names())
def test_a_model_as_it_is_has_its_values_bit_for_bit(name: str) -> None:
    """Nothing is scaled, and a restated dimension changes nothing."""
    model = actuator_model(name, 'test')
    stated = {'cylinder': CYLINDER, 'hydraulic_motor': MOTOR}
    assert bool(model.stated) == (name in stated)
    alone = default_actuator(name, 'ram')
    run = own(stated.get(name, '      {}\n'), name, 20.7, model.default_load)
    assert (sheet_of(run), run.actuators[0].load) == (alone.sheet, alone.load)
    restated = own('      plant: {drive: {bore_mm: 21.5}}\n', supply=20.7)
    assert sheet_of(restated) == default_actuator('isa_v5', 'ram').sheet


def test_the_stops_of_a_load_follow_the_stroke() -> None:
    run = own('      plant: {drive: {stroke_mm: 50.0}}\n', load='wheel')
    load = run.actuators[0].load
    assert (load.stop_low, load.stop_high) == pytest.approx((0.0025, 0.0475), rel=1e-12, abs=0.0)


def test_the_table_shows_the_scaled_value_and_its_source(tmp_path: Path) -> None:
    """`isa params` of the file, and the configuration that is recorded."""
    path = tmp_path / 'own.yaml'
    path.write_text(HEAD % (14.0, 'isa_v5', 'mass') + OWN)
    line = next(line for line in describe(str(path)).splitlines()
                if line.startswith('reu.position.force_in '))
    assert '10720.63' in line and 'derived, A_B P_S; scaled with stall_in' in line
    unchanged = next(line for line in describe('isa_v5').splitlines()
                     if line.startswith('reu.position.force_in '))
    assert ' 5174 ' in unchanged and 'derived, A_B P_S; scales with stall_in' in unchanged
    run = own()
    assert run_of_text(run.to_yaml()).actuators == run.actuators
    assert 'scales_with' not in run.to_yaml()


def test_a_quantity_is_computed_once_for_all_values_that_scale_with_it(monkeypatch) -> None:
    """Of the model and of the own actuator, for its plant and for its REU: four at most."""
    counts: dict[str, int] = {}

    def counted(name: str, quantity: Quantity) -> Quantity:
        def counting(sheet: ActuatorSheet) -> float:
            counts[name] = counts.get(name, 0) + 1
            return quantity(sheet)
        return counting
    monkeypatch.setattr(scaling, 'SCALES', {
        name: counted(name, quantity) for name, quantity in SCALES.items()})
    own()
    assert counts['piston_area'] >= 2 and max(counts.values()) <= 4, counts


def test_a_spool_that_is_too_fast_is_refused_by_its_own_section() -> None:
    """The current loop follows at ten times its speed; the file has no key of the coil."""
    with pytest.raises(ConfigError, match=(
            r'plant\.coil\.bandwidth_rad_per_s \(scaled with spool_frequency: 11\.3 times the '
            r"model's, by plant\.spool\) = 71084 rad/s, must be <= 50000 rad/s")):
        isa_ros.load('rig_cylinder').replace({'actuators.ram.parameters.plant.spool': {
            'kind': 'response', 'minus_90_deg_hz': 1000.0, 'minus_3_db_hz': 1000.0}})


def built(monkeypatch, parameters: str) -> int:
    """Return how many sheets are built for a run with another value, its model being known."""
    own(parameters)
    count = 0

    def counting(cls: type[Parameters], *given: Any) -> Parameters:
        nonlocal count
        count += cls is ActuatorSheet
        return build(cls, *given)
    monkeypatch.setattr(scaling, 'build', counting)
    own(parameters)
    return count


def test_what_no_ratio_follows_takes_one_sheet_and_a_bore_four(monkeypatch) -> None:
    assert built(monkeypatch, '      plant: {friction: {viscous: 300.0}}\n') == 1
    assert built(monkeypatch, OWN) == 4


def test_a_known_model_hides_no_other_one() -> None:
    """The model is kept by all of its values: a run without values of its own has its sheet."""
    sheets = []
    for preset in ('default', 'table_4', 'default'):
        text = HEAD.replace('    parameters:', f'    preset: {preset}') % (14.0, 'isa_v5', 'mass')
        sheets.append(sheet_of(run_of(parse(text, 'own.yaml'), Place('own.yaml'))[0]))
    assert sheets[0] == sheets[2] != sheets[1]
    assert sheets[1].reu.force.kp == 2.0e-8 < sheets[2].reu.force.kp    # type: ignore[union-attr]
