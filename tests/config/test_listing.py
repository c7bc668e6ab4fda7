"""`isa params`: every parameter once, with its source."""

from itertools import product
from pathlib import Path
import re

from isa_ros.actuator.sheet import ActuatorSheet
from isa_ros.config.listing import describe, ListedValue, rows
from isa_ros.config.models.catalogue import actuator_model, leg_names, leg_section, model_names
from isa_ros.config.text.parameter_sets import build, build_one_of
from isa_ros.errors import ConfigError, IsaError
from isa_ros.loads.sheets import LocalLoad
from isa_ros.scripting.run import load
from isa_ros.surroundings.bodies.leg.sheet import LegSheet
import pytest

SOURCES = ('paper', 'derived', 'assumed', 'public model')


def is_kind(row: ListedValue) -> bool:
    """Return whether a row is a kind of model, which has no number and no source."""
    return row.parameter.endswith('.kind')


@pytest.mark.parametrize('name', model_names())
def test_every_value_of_a_model_has_its_source(name: str) -> None:
    """Every preset and variant of a model is a whole sheet, and every value has a source."""
    model = actuator_model(name, 'model')
    printed = {'table_4'} if name in ('isa_v5', 'smart_manifold') else set()
    assert {'default'} | printed == set(model.presets)
    for preset, variant in product(model.presets, ['', *model.variants]):
        section = model.with_variants(
            model.with_preset(preset, 'preset'), [variant] if variant else [], 'variant')
        table = rows(build(ActuatorSheet, section, model.place), section)
        assert table and all(
            row.source.startswith(SOURCES) for row in table if not is_kind(row))
        assert len({row.parameter for row in table}) == len(table)


@pytest.mark.parametrize('name', leg_names())
def test_every_value_of_a_leg_has_its_source(name: str) -> None:
    section, place = leg_section(name, 'leg')
    assert all(row.source.startswith(SOURCES)
               for row in rows(build(LegSheet, section, place), section) if not is_kind(row))


def test_a_row_shows_value_unit_range_and_source() -> None:
    """The paper's Table 2: bore 21.5 mm."""
    line = next(line for line in describe('isa_v5', 'default').splitlines()
                if line.startswith('plant.drive.bore_mm '))
    assert line.split('  ')[0] == 'plant.drive.bore_mm'
    for cell in ('21.5', 'mm', '> 0, <= 500', 'paper Table 2', 'piston diameter'):
        assert cell in line


def test_a_run_shows_each_actuator_and_where_its_values_come_from() -> None:
    text = describe('rig_rotary')
    assert 'actuators.rotor.parameters: smart_manifold, preset table_4' in text
    assert 'actuators.rotor.load: wheel' in text
    assert '20.7   MPa' in text.replace('    ', '   ') and 'rig_rotary.yaml' in text


@pytest.mark.parametrize('name', ['leg', 'rig_rotary'])
def test_title_and_row_are_the_key_of_a_value(name: str) -> None:
    """A run with the shown value written at the shown key is the same run."""
    run = load(name)
    tables = [text.splitlines() for text in describe(name).split('\n\n')]
    for title, _, *body in tables[1:]:      # the first one has the keys of the resolved text
        key, value = next(row.split()[:2] for row in body if row.split()[1][0].isdigit())
        section = title.partition(':')[0].partition(' of ')[0]
        same = run.replace({f'{section}.{key}': float(value)})
        assert same.configuration == run.configuration, key


def test_single_values_have_their_keys() -> None:
    """Those of the resolved text; what the file leaves out is a default."""
    text = describe('rig_rotary', values={'tick_timeout_s': 6.0})
    assert text.startswith('values of rig_rotary.yaml\n')
    assert shown(text, 'tick_timeout_s') == ['6', '--set']
    assert shown(text, 'seed') == ['0', 'default']
    assert shown(text, 'actuators.rotor.preset') == ['table_4', 'rig_rotary.yaml']
    assert re.search(r'^step_ns +1000000 +ns +rig_rotary.yaml +the macro step', text, re.M)


@pytest.mark.parametrize('name', ['rig_rotary', 'rig_rotary.yaml', 'hyq_real'])
@pytest.mark.parametrize('option, preset, variants', [
    ('--preset', 'table_4', ()), ('--variant', None, ('explicit',))])
def test_what_is_no_model_refuses_preset_and_variants(name, option, preset, variants) -> None:
    """A run file sets them itself, so the options would have no effect."""
    with pytest.raises(ConfigError, match=f'^{option} is not used: {name} is not a model'):
        describe(name, preset, variants)


def test_a_model_shows_its_loads() -> None:
    """Each load has its kind, if that is not its name, and its sources."""
    text = describe('smart_manifold', 'default')
    assert '\n\nload drop_rig\n' in text and '\n\nload wood, a pad\n' in text
    assert '\n\nload wheel\n' in text
    line = next(line for line in text.splitlines() if line.startswith('slack '))
    assert '250 Nm of paper section 5.1' in line


@pytest.mark.parametrize('name', model_names())
def test_every_value_of_a_load_has_its_source(name: str) -> None:
    model = actuator_model(name, 'model')
    for kind, section in model.loads.items():
        table = rows(build_one_of(LocalLoad, section, model.place / kind), section)
        assert table and all(
            row.source.startswith(SOURCES) for row in table if not is_kind(row))


def test_a_variant_is_shown_with_its_kinds() -> None:
    """The explicit coil replaces the closed loop; the other variants are listed."""
    text = describe('isa_v5', 'table_4', ['explicit'])
    kind = next(line for line in text.splitlines() if line.startswith('plant.coil.kind '))
    assert kind.split()[1:5] == ['explicit', 'closed_loop', '|', 'explicit']
    assert 'plant.coil.mode_frequency_hz' in text
    assert 'variants: feedback_linearisation, explicit' in text


def shown(text: str, parameter: str) -> list[str]:
    """Return value and source of the first row of a parameter."""
    cells = next(re.split(' {2,}', line) for line in text.splitlines()
                 if line.startswith(f'{parameter} '))
    return [cells[1], cells[-2]]


def test_a_changed_value_is_shown_with_what_follows_from_it() -> None:
    """A_A P_S of 40 mm at 14 MPa is 3.46 times that of 21.5 mm; the stops are the load's."""
    text = describe('isa_v5', values={
        'plant.drive.bore_mm': 40, 'plant.drive.rated_pressure_mpa': 14.0, 'load.kind': 'wheel'})
    assert shown(text, 'plant.drive.bore_mm') == ['40', '--set']
    assert shown(text, 'plant.drive.rated_pressure_mpa') == ['14', '--set']
    assert shown(text, 'pressure_mpa')[0] == '20.7'
    value, source = shown(text, 'reu.position.force_out')
    assert float(value) == pytest.approx(7500.0 * 14.0 / 20.7 * (40.0 / 21.5) ** 2, rel=1e-5)
    assert source.endswith('scaled with stall_out')
    assert 'actuators.isa_v5.load: wheel' in text
    assert shown(describe('isa_v5'), 'plant.drive.bore_mm') == ['21.5', 'paper Table 2']


def test_a_changed_value_of_a_run_file_has_its_key() -> None:
    """A key of the actuator suffices where there is one; a section changes all of its values."""
    text = describe('leg', values={
        'actuators.kfe.parameters.reu.force.kp': 4e-8, 'leg.ground': 'wood',
        'leg.start': {'haa_deg': 0.0, 'hfe_deg': 41.3, 'kfe_deg': -80.0, 'foot_height_mm': 50.0,
                      'release_s': 0.0}})
    hfe, kfe = text.index('actuators.hfe.parameters'), text.index('actuators.kfe.parameters')
    assert shown(text[hfe:kfe], 'reu.force.kp')[1] != '--set'
    assert shown(text[kfe:], 'reu.force.kp') == ['4e-08', '--set']
    assert shown(text, 'ground.stiffness')[0] == '10000000'
    assert shown(text, 'foot_height_mm') == ['50', '--set']
    assert shown(describe('rig_rotary', values={'reu.force.kf': 0}), 'reu.force.kf') == [
        '0', '--set']
    assert shown(describe('hyq_real', values={'ground.damping': 1}), 'ground.damping') == [
        '1', '--set']


@pytest.mark.parametrize(('name', 'key', 'message'), [
    ('isa_v5', 'reu.force.kq', 'reu.force.kq is unknown; valid: rate_hz'),
    ('leg', 'reu.force.kp', 'leg.yaml: reu is unknown; valid: name'),
    ('hyq_real', 'ground.friction', '--set: ground.friction = -1, must be >= 0.01 ')])
def test_a_changed_value_is_checked(name: str, key: str, message: str) -> None:
    with pytest.raises(IsaError, match=message):
        describe(name, values={key: -1})


def test_an_empty_list_is_listed_as_none() -> None:
    table = describe('rig_linear', values={'emergency_stops.all.reactions': []})
    line = next(line for line in table.splitlines() if 'emergency_stops.all.reactions' in line)
    assert line.split()[1] == 'none'


def source_in(text: str, parameter: str) -> str:
    """Return the row of a parameter, which has its source."""
    return next(line for line in text.splitlines() if line.startswith(f'{parameter} '))


def test_the_values_of_a_robot_are_from_its_file(tmp_path):
    """But those that stand beside it in the run file, and what the run file has itself."""
    path = tmp_path / 'pair.yaml'
    path.write_text(
        'name: pair\nrobots:\n  r1: {file: leg}\n  r2: {file: leg, actuators: {kfe: {model: '
        'isa_v2, preset: default}}}\nseed: 3\n')
    text = describe(str(path))
    for parameter, file in (
            ('actuators.r1/kfe.model', ' leg.yaml '), ('actuators.r2/kfe.model', ' pair.yaml '),
            ('actuators.r2/hfe.model', ' leg.yaml '), ('bodies.r2.model', ' leg.yaml '),
            ('supplies.r1/supply.feeds', ' leg.yaml '), ('seed', ' pair.yaml ')):
        assert file in source_in(text, parameter), parameter


def test_what_a_file_leaves_out_of_a_circuit_has_its_own_source():
    text = describe('pump_station')
    for parameter, source in (
            ('parts.pump.worn_lpm_per_mpa', 'assumed, no fault'),
            ('parts.tank.pressure_mpa', 'assumed, open'),
            ('parts.press.returns_to', 'pump_station.yaml'),
            ('parts.pump.leakage_lpm_per_mpa', 'pump_station.yaml'),
            ('parts.safety.opens_mpa', 'pump_station.yaml'),
            ('parts.safety.kind', 'pump_station.yaml')):
        assert f' {source} ' in source_in(text, parameter), parameter


BARE = """
name: own
supply: {kind: constant, pressure_mpa: 16.0, return_pressure_mpa: 0.0}
actuators:
  ram: {model: isa_v5, load: {kind: mass}}
"""


@pytest.mark.parametrize(('more', 'sources'), [
    ('', ('default', 'default')), ('step_ms: 2.0\n', ('own.yaml', 'default')),
    ('controller_offset_ns: 140000\n', ('default', 'own.yaml'))])
def test_a_time_that_the_file_lacks_is_the_default(
        tmp_path: Path, more: str, sources: tuple[str, str]) -> None:
    """In ms or ns: the resolved text has it in ns."""
    path = tmp_path / 'own.yaml'
    path.write_text(BARE + more)
    lines = describe(str(path)).splitlines()
    for key, source in zip(('step_ns', 'controller_offset_ns'), sources):
        line, = (line for line in lines if line.startswith(f'{key} '))
        assert re.split(r'\s{2,}', line)[3] == source
