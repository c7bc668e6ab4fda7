"""Supplies and body in a run file: both forms, and what they resolve to."""

from pathlib import Path

from isa_ros.config.runs.run_config import RunConfig
from isa_ros.config.runs.run_file import load_run
from isa_ros.errors import ConfigError
from isa_ros.surroundings.return_line import HeldReturn, VolumeReturn
from isa_ros.surroundings.supply import AccumulatorSupply, ConstantSupply
import pytest

CONFIG = Path(__file__).parents[3] / 'config'
HEAD = 'name: rig\nstep_ms: 1.0\ncontroller_offset_ms: 0.12\ntick_timeout_s: 5.0\n'
ACTUATORS = """\
actuators:
  hip: {model: smart_manifold, load: {kind: wheel}}
  knee: {model: isa_v5, load: {kind: mass}}
  ankle: {model: isa_v5, load: {kind: mass}}
"""
TWO = """\
supplies:
  main:
    kind: accumulator
    pressure_mpa: 20.7
    return_pressure_mpa: 0.5
    gas_volume_l: 0.32
    precharge_mpa: 12.0
    polytropic_exponent: 1.3
    line_volume_l: 0.5
    bulk_modulus: 1.0e+9
    pump_flow_lpm: 12.0
    pump_lag_s: 0.03
    pump_band_mpa: 0.5
    relief_mpa: 22.5
    relief_lpm_per_mpa: 10.0
    return_line: {kind: volume, oil_volume_l: 0.5, bulk_modulus: 1.0e+9, tank_lpm_per_mpa: 40.0}
    feeds: [ankle, hip]
  low: {kind: constant, pressure_mpa: 16.0, return_pressure_mpa: 0.0, feeds: [knee]}
"""
ONE = 'supply: {kind: constant, pressure_mpa: 20.7, return_pressure_mpa: 0.0}\n'
ALL = ('supplies: {supply: {kind: constant, pressure_mpa: 20.7, return_pressure_mpa: 0.0, '
       'feeds: [hip, knee, ankle]}}\n')
CONSTANT = '{kind: constant, pressure_mpa: 20.7, return_pressure_mpa: 0.0'


def run_of(tmp_path: Path, supplies: str, name: str = 'rig.yaml') -> RunConfig:
    """Return the run of three actuators on these supplies."""
    path = tmp_path / name
    path.write_text(HEAD + supplies + ACTUATORS, encoding='utf-8')
    return load_run(path)


def test_each_supply_feeds_the_actuators_it_names(tmp_path: Path) -> None:
    """In the order of the file, as the supply has them."""
    run = run_of(tmp_path, TWO)
    assert [(own.name, type(own.sheet), own.feeds) for own in run.supplies] == [
        ('main', AccumulatorSupply, ('ankle', 'hip')), ('low', ConstantSupply, ('knee',))]
    assert run.supply_of('knee').pressure_mpa == 16.0
    assert run.supply_of('hip') == run.supply_of('ankle') == run.supplies[0].sheet
    line = run.supplies[0].sheet.return_line
    assert line == VolumeReturn(oil_volume_l=0.5, bulk_modulus=1e9, tank_lpm_per_mpa=40.0)
    assert run.supplies[1].sheet.return_line == HeldReturn()
    with pytest.raises(ConfigError, match="no actuator 'elbow'; valid: hip, knee, ankle"):
        run.supply_of('elbow')


def test_one_supply_feeds_all_of_them(tmp_path: Path) -> None:
    """The short form is the supply of this name that feeds every actuator."""
    short, long = run_of(tmp_path, ONE), run_of(tmp_path, ALL)
    assert short == long and short.digest == long.digest
    assert short.supplies[0].feeds == ('hip', 'knee', 'ankle')


def test_a_run_of_one_actuator_keeps_the_supply_of_its_own(tmp_path: Path) -> None:
    run = run_of(tmp_path, TWO)
    for name in ('knee', 'hip'):
        alone = run.alone(run.actuator(name))
        assert [own.feeds for own in alone.supplies] == [(name,)]
        assert alone.supply_of(name) == run.supply_of(name)


@pytest.mark.parametrize(('supplies', 'message'), [
    (f'supplies: {{main: {CONSTANT}, feeds: [hip, knee, ankle, hip]}}}}\n',
     "supplies.main.feeds: 'hip' is already fed by main"),
    (f'supplies: {{main: {CONSTANT}, feeds: hip}}}}\n', 'supplies.main.feeds'),
    (f'supplies: {{main: {CONSTANT}, feeds: [hip, knee]}}}}\n', "supplies: 'ankle' is not fed"),
    ('supplies: {}\n', "supplies: 'hip', 'knee', 'ankle' are not fed; add them to "),
    ('supplies: [main]\n', 'supplies'),
    (f'supplies: {{main: {CONSTANT}, feed: [hip, knee, ankle]}}}}\n', 'lacks feeds'),
    (f'supplies: {{main: {CONSTANT}, flow: 1, feeds: [hip, knee, ankle]}}}}\n',
     'supplies.main.flow is unknown'),
    (f'supplies: {{main: {CONSTANT}, return_line: {{kind: volume}}, '
     'feeds: [hip, knee, ankle]}}\n', 'supplies.main.return_line.*lacks oil_volume_l'),
    (f'supplies: {{main: {CONSTANT}, return_line: {{kind: held, oil_volume_l: 1}}, '
     'feeds: [hip, knee, ankle]}}\n', 'supplies.main.return_line.oil_volume_l is unknown')])
def test_supplies_that_cannot_be_are_refused(
        tmp_path: Path, supplies: str, message: str) -> None:
    """By file and key; config/bad has the rest."""
    with pytest.raises(ConfigError, match=rf'^rig.yaml: .*{message}'):
        run_of(tmp_path, supplies)


@pytest.mark.parametrize('file', ['leg.yaml', 'hyq_leg.yaml'])
def test_a_body_of_kind_leg_is_the_leg(tmp_path: Path, file: str) -> None:
    """Both forms of the section give one run, by the same digest."""
    text = (CONFIG / file).read_text(encoding='utf-8')
    assert text.count('\nleg:\n') == 1
    path = tmp_path / file
    path.write_text(text.replace('\nleg:\n', '\nbody:\n  kind: leg\n'), encoding='utf-8')
    run, plain = load_run(path), load_run(CONFIG / file)
    assert run == plain and run.digest == plain.digest
    assert run.bodies == (run.leg,)


@pytest.mark.parametrize(('body', 'message'), [
    ('body: leg\n', "body = 'leg', must be a section"),
    ('body: {}\n', 'body.kind = None, must be one of leg'),
    ('body: {kind: leg, model: hyq_real, joint: {}}\n', 'body.joint is unknown')])
def test_a_body_that_cannot_be_is_refused(tmp_path: Path, body: str, message: str) -> None:
    with pytest.raises(ConfigError, match=f'^rig.yaml: {message}'):
        run_of(tmp_path, body + ONE)


def test_errors_of_a_body_name_the_section_that_was_written(tmp_path: Path) -> None:
    """The keys below are those of a leg."""
    text = (CONFIG / 'leg.yaml').read_text(encoding='utf-8').replace(
        '\nleg:\n', '\nbody:\n  kind: leg\n').replace('hfe_deg: 41.3', 'hfe_deg: 4.0')
    path = tmp_path / 'leg.yaml'
    path.write_text(text, encoding='utf-8')
    with pytest.raises(ConfigError, match='^leg.yaml: body.start.hfe_deg = 4 deg, must be within'):
        load_run(path)
