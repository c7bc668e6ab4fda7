"""Run files: the shipped ones, overrides, and the resolved text."""

from functools import cache
from pathlib import Path
import re
from typing import Any

from isa_ros.config.runs.run_config import RunConfig
from isa_ros.config.runs.run_file import load_run
from isa_ros.config.runs.run_reading import run_of, run_of_text
from isa_ros.config.text.sections import Place
from isa_ros.config.text.yaml_text import read
from isa_ros.errors import ConfigError
from isa_ros.loads.drop_rig import Wheel
from isa_ros.loads.sheets import Blocked, Mass
import pytest
from tests.config.rig_file import rig

CONFIG = Path(__file__).parents[3] / 'config'
SHIPPED = sorted(CONFIG.glob('*.yaml'))


@cache
def shipped_run(path: Path) -> RunConfig:
    """Return a shipped run, which is immutable."""
    return load_run(path)


@pytest.mark.parametrize('path', SHIPPED, ids=lambda path: path.stem)
def test_a_shipped_run_survives_its_resolved_text(path: Path) -> None:
    """The bag has this text; replay must get the same run from it, bit for bit."""
    run = shipped_run(path)
    text = run.to_yaml()
    again = run_of_text(text)
    assert again == run
    assert again.to_yaml() == text and again.digest == run.digest
    assert str(path.parent) not in text


@pytest.mark.parametrize('path', SHIPPED, ids=lambda path: path.stem)
def test_a_resolved_text_is_a_run_file(path: Path, tmp_path: Path) -> None:
    """Of the same run, bit for bit, under any name."""
    run = shipped_run(path)
    again = tmp_path / 'again.yaml'
    again.write_text(run.to_yaml(), encoding='utf-8')
    found = load_run(again)
    assert found == run and found.digest == run.digest


def test_a_joint_of_a_leg_may_have_a_sheet_of_its_own(tmp_path: Path) -> None:
    """Its position is that of the joint unless the file has one."""
    path = tmp_path / 'leg.yaml'
    path.write_text(load_run(CONFIG / 'leg.yaml').to_yaml(), encoding='utf-8')
    run = load_run(path, {'actuators.kfe.initial_position': 0.01})
    assert run.actuator('kfe').initial_position == 0.01
    with pytest.raises(ConfigError, match='kfe.load is not used: the actuator moves kfe of the l'):
        load_run(path, {'actuators.kfe.load': {'kind': 'blocked'}})
    plain = CONFIG / 'leg.yaml'
    with pytest.raises(ConfigError, match='kfe.initial_position is not used: the actuator moves'):
        load_run(plain, {'actuators.kfe.initial_position': 0.01})


def test_inertial_units_of_a_resolved_text_are_those_of_the_file(tmp_path: Path) -> None:
    """Their keys stand below a sheet of their own there."""
    run = load_run(CONFIG / 'leg.yaml', {'leg.imus': {'trunk': {'link': 'hip', 'x_mm': 30.0}}})
    text = run.to_yaml()
    assert re.search(r'^ +trunk:\n +sheet: \{rate_hz: .*\n?.* link: hip\}', text, re.MULTILINE)
    assert run_of_text(text) == run
    with pytest.raises(ConfigError, match=r'^leg.yaml: leg.imus.trunk.y_m is unknown'):
        load_run(CONFIG / 'leg.yaml', {'leg.imus': {'trunk': {'link': 'hip', 'y_m': 0.0}}})


def test_times_have_defaults(tmp_path: Path) -> None:
    """Those that most shipped files have."""
    text = (CONFIG / 'rig_linear.yaml').read_text(encoding='utf-8')
    short = '\n'.join(line for line in text.splitlines() if not line.startswith(
        ('step_ms', 'controller_offset_ms', 'tick_timeout_s')))
    path = tmp_path / 'rig_linear.yaml'
    path.write_text(short, encoding='utf-8')
    assert load_run(path) == load_run(CONFIG / 'rig_linear.yaml')


def test_the_leg_is_the_one_of_the_design() -> None:
    """interface.md: HAA smart manifold, HFE and KFE ISA v5; no own loads."""
    run = load_run(CONFIG / 'leg.yaml')
    assert [(a.name, a.model, a.load) for a in run.actuators] == [
        ('haa', 'smart_manifold', None), ('hfe', 'isa_v5', None), ('kfe', 'isa_v5', None)]
    assert (run.step_ns, run.controller_offset_ns) == (1_000_000, 120_000)


def test_an_override_replaces_one_value_of_one_actuator(tmp_path: Path) -> None:
    plain = load_run(rig(tmp_path)).actuator('ram')
    ram = ('model: isa_v5, load: {kind: mass}, '
           'parameters: {plant: {oil: {aeration_pressure_kpa: 2.5}}}')
    changed = load_run(rig(tmp_path, ram)).actuator('ram')
    assert changed.sheet.plant.oil.aeration_pressure_kpa == 2.5
    assert changed.sheet.reu == plain.sheet.reu
    assert changed.sheet.plant.valve == plain.sheet.plant.valve


def test_a_preset_gives_other_gains(tmp_path: Path) -> None:
    """Physics.md, errata 11: table_4 has 0.02 mm/kN = 2e-8 m/N."""
    run = load_run(rig(tmp_path, 'model: isa_v5, preset: table_4, load: {kind: blocked}'))
    ram = run.actuator('ram')
    assert ram.preset == 'table_4' and ram.sheet.reu.force.kp == 2.0e-8
    assert isinstance(ram.load, Blocked)


def test_own_loads_take_the_values_of_the_model_but_for_those_given(tmp_path: Path) -> None:
    run = load_run(rig(tmp_path))
    ram, rotor = run.actuators
    assert isinstance(ram.load, Mass) and ram.load.inertia == 50.0
    assert isinstance(rotor.load, Wheel) and rotor.load.inertia == 0.4


@pytest.mark.parametrize('ram, expected', [
    ('model: isa_v5, load: {kind: mass}, initial_position_deg: 3',
     'rig.yaml: actuators.ram.initial_position_deg is unknown: the actuator is linear, the key '
     'is initial_position_mm'),
    ('model: isa_v5, load: {kind: mass}, initial_position_mm: 100.5', 'must be <= 100 mm'),
    ('model: isa_v5, load: {kind: mass, inertia: 0}',
     'rig.yaml: actuators.ram.load.inertia = 0 kg, must be > 0'),
    ('model: isa_v5, load: {kind: external}',
     'wood; a load that a program gives is body: {kind: external, actuators: [NAME]}'),
    ('load: {kind: mass}', 'rig.yaml: actuators.ram lacks model, one of cylinder, '),
    ('model: [isa_v5], load: {kind: mass}', "actuators.ram.model = ['isa_v5'] is not a model"),
    ('model: isa_v5, load: mass', "actuators.ram.load = 'mass', must be a section"),
    ('model: isa_v5, load: {kind: mass}, parameters: {plant: {friction: {viscous: 9e5}}}',
     'rig.yaml: actuators.ram: plant.mechanics.inertia = 0.6 kg, must be >= 6.64 kg; or '
     'plant.friction.viscous = 900000 Ns/m, must be <= 5.89e+04 Ns/m, for the plant step of '
     '20 us'),
    ('model: isa_v5, load: {kind: mass}, parameters: {reu: {current: {rate_hz: 30000}}}',
     'rig.yaml: actuators.ram: current.rate_hz = 30000 Hz, its period must be whole nanosec'),
])
def test_a_wrong_actuator_is_refused_by_file_and_key(
        tmp_path: Path, ram: str, expected: str) -> None:
    with pytest.raises(ConfigError) as caught:
        load_run(rig(tmp_path, ram))
    assert expected in str(caught.value)
    assert '\n' not in str(caught.value)


def test_the_foot_stands_on_the_named_material(tmp_path: Path) -> None:
    """leg.ground replaces the model's ground; single values take precedence; the text has all."""
    text = (CONFIG / 'leg.yaml').read_text(encoding='utf-8')
    path = tmp_path / 'leg.yaml'
    path.write_text(text + '  ground: wood\n  parameters: {ground: {friction: 0.4}}\n')
    run, plain = load_run(path), load_run(CONFIG / 'leg.yaml')
    assert run.leg is not None and plain.leg is not None
    ground = run.leg.sheet.ground
    assert (ground.stiffness, ground.damping, ground.friction) == (1e7, 0.4, 0.4)
    assert plain.leg.sheet.ground.stiffness == 3e6
    assert run_of_text(run.to_yaml()) == run


@pytest.mark.parametrize(('load', 'name'), [
    ('kind: mass', 'Mass'), ('kind: blocked', 'Blocked'), ('kind: wheel', 'Wheel'),
    ('kind: wood', 'Pad'), ('kind: metal, gap: 0.01', 'Pad')])
def test_a_load_is_named_or_of_its_kind(tmp_path: Path, load: str, name: str) -> None:
    """A named load has another kind, which the resolved text contains; it is read back."""
    run = load_run(rig(tmp_path, f'model: isa_v5, load: {{{load}}}'))
    assert type(run.actuator('ram').load).__name__ == name
    assert f'kind: {name.lower()}' in run.to_yaml()
    assert run_of_text(run.to_yaml()) == run


def test_the_digest_changes_with_any_parameter(tmp_path: Path) -> None:
    plain = load_run(rig(tmp_path)).digest
    ram = 'model: isa_v5, load: {kind: mass, inertia: 50.00000000000001}'
    assert load_run(rig(tmp_path, ram)).digest != plain


@pytest.mark.parametrize('old, new, expected', [
    ('step_ns: 1000000', 'step_ns: 1.0', 'step_ns = 1.0, must be of type int'),
    ('preset: default', 'presets: default', 'actuators.haa.presets is unknown'),
    ('    model: smart_manifold\n', '', 'actuators.haa.model = None, must be of type str'),
    ('stroke_mm: 100.0', 'stroke_mm: -1', 'drive.stroke_mm = -1 mm, must be > 0 mm'),
])
def test_a_damaged_resolved_text_is_refused(old: str, new: str, expected: str) -> None:
    text = load_run(CONFIG / 'leg.yaml').to_yaml()
    assert old in text
    with pytest.raises(ConfigError, match=expected):
        run_of_text(text.replace(old, new, 1))


def test_a_text_from_before_a_parameter_is_read() -> None:
    """A leg's bag from before the parameter of the hip drop: the axes crossed at one height."""
    run = load_run(CONFIG / 'leg.yaml')
    text = run.to_yaml()
    assert '      hip_drop_m: 0.0\n' in text
    assert run_of_text(text.replace('      hip_drop_m: 0.0\n', '', 1)) == run


def test_origins_say_which_file_a_value_comes_from(tmp_path: Path) -> None:
    ram = ('model: isa_v5, load: {kind: mass}, '
           'parameters: {plant: {oil: {aeration_pressure_kpa: 2.5}}}')
    _, origins = run_of(read(rig(tmp_path, ram)), Place('rig.yaml'))
    plant = origins['actuators.ram.sheet']['plant']
    assert isinstance(plant, dict) and isinstance(plant['oil'], dict)
    assert plant['oil']['aeration_pressure_kpa'].source == 'rig.yaml'  # type: ignore[union-attr]


@pytest.mark.parametrize(('names', 'message'), [
    (['hfe'], "leg.yaml: controllers: the name 'hfe' is taken"),
    (['coordinator'], "leg.yaml: controllers: the name 'coordinator' is taken"),
    (['sway', 'sway'], "leg.yaml: controllers: the name 'sway' is taken"),
    (['Sway'], "leg.yaml: controllers = 'Sway', must be small letters")])
def test_a_controller_that_cannot_be_is_refused(names, message):
    with pytest.raises(ConfigError, match=message):
        load_run(CONFIG / 'leg.yaml').with_controllers(names)


def test_controllers_of_file_and_command_line_take_part(tmp_path):
    """In this order, also in the text stored in a bag."""
    path = tmp_path / 'leg.yaml'
    path.write_text((CONFIG / 'leg.yaml').read_text() + 'controllers: [gait, balance]\n')
    run = load_run(path).with_controllers(['sway'])
    assert run.controllers == ('gait', 'balance', 'sway')
    assert run_of_text(run.to_yaml()) == run


SUPPLY = {'kind': 'constant', 'pressure_mpa': 20.7, 'return_pressure_mpa': 0.0}
RAM = {'model': 'isa_v5', 'load': {'kind': 'mass'}}


@pytest.mark.parametrize(('tree', 'message'), [
    ({'supply': SUPPLY, 'actuators': {'supply': RAM}},
     "actuators.supply: the name 'supply' is taken by a supply; columns"),
    ({'supplies': {'pump': {**SUPPLY, 'feeds': ['pump']}}, 'actuators': {'pump': RAM}},
     "actuators.pump: the name 'pump' is taken by a supply"),
    ({'supply': SUPPLY, 'body': {'kind': 'external', 'actuators': ['body']},
      'actuators': {'body': {'model': 'isa_v5'}}},
     "actuators.body: the name 'body' is taken by the body"),
])
def test_two_things_of_one_name_are_refused(tree: dict[str, Any], message: str) -> None:
    """A result would lose columns of the one, and the accounts the other."""
    with pytest.raises(ConfigError, match=f'rig.yaml: {message}'):
        run_of({'name': 'rig', **tree}, Place('rig.yaml'))


def test_a_name_has_at_most_a_hundred_letters() -> None:
    for n, is_short in ((100, True), (101, False)):
        tree = {'name': 'rig', 'supply': SUPPLY, 'actuators': {'a' * n: RAM}}
        if is_short:
            assert run_of(tree, Place('rig.yaml'))[0].actuators[0].name == 'a' * n
            continue
        with pytest.raises(ConfigError, match="= 'a{20}.*, at most 100") as raised:
            run_of(tree, Place('rig.yaml'))
        assert len(str(raised.value)) < 300
