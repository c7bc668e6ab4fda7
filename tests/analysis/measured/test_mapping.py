"""The mapping file: what it says, and one line for what it must not say."""

from pathlib import Path

from isa_ros.analysis.measured.mapping import load_mapping, SignalSource
from isa_ros.analysis.measured.quantities import QUANTITIES, scale_of
from isa_ros.errors import ConfigError
import pytest

GOOD = """
actuator: ram
time: {column: stamp, unit: ms}
skip_lines: 7
clock_ppm: 40
signals:
  position: {column: 3, unit: mm, sign: -1, scale: 0.5, offset: 12.0, delay_ms: 2}
  force: {topic: /cell, field: 'wrench.force.x', unit: kN}
"""


def mapping(tmp_path: Path, text: str = GOOD):
    path = tmp_path / 'map.yaml'
    path.write_text(text)
    return load_mapping(path)


def test_every_key_has_its_meaning(tmp_path: Path) -> None:
    own = mapping(tmp_path)
    assert own[:2] == ('map.yaml', 'ram')
    assert (own.time, own.time_scale, own.rate, own.skip_lines) == ('stamp', 1e-3, None, 7)
    assert own.clock == pytest.approx(4e-5, rel=1e-12, abs=0.0)
    position, force = own.signals['position'], own.signals['force']
    assert position.source == SignalSource(3, '', '') and position.unit == 'mm'
    assert (position.factor, position.offset, position.delay) == (-0.5, 12.0, 0.002)
    assert force.source == SignalSource(None, '/cell', 'wrench.force.x')
    assert (force.factor, force.offset, force.delay) == (1.0, 0.0, 0.0)
    assert mapping(tmp_path, 'time: {rate_hz: 500}\nsignals: {spool: {column: 1, unit: m}}'
                   ).rate == 500.0


@pytest.mark.parametrize('change, expected', [
    (('actuator', 'actuato'), 'map.yaml: actuato is unknown; did you mean actuator'),
    (('position:', 'positon:'), 'map.yaml: signals.positon is unknown; did you mean position'),
    (('column: 3, ', ''), 'map.yaml: signals.position: must have either column, or topic and'),
    (('column: 3', 'column: 3, topic: /x'), 'must have either column, or topic and field'),
    (("field: 'wrench.force.x', ", ''), 'map.yaml: signals.force: lacks field'),
    (('unit: kN', 'sign: 1'), 'map.yaml: signals.force: lacks unit'),
    (('sign: -1', 'sign: 2'), 'map.yaml: signals.position.sign = 2, must be 1 or -1'),
    (('scale: 0.5', 'scale: x'), "map.yaml: signals.position: scale = 'x', must be a number"),
    (('scale: 0.5', 'scale: -0.0'), 'map.yaml: signals.position: scale = 0, must not be 0'),
    (('clock_ppm: 40', 'clock_ppm: true'), 'map.yaml: clock_ppm = True, must be a number'),
    (('skip_lines: 7', 'skip_lines: -1'), 'skip_lines = -1, must be a whole number >= 0'),
    (('unit: ms', 'unit: mm'), "map.yaml: time.unit = 'mm', must be one of s, ms, us"),
    (('unit: ms', 'rate_hz: 5'), 'time has column and rate_hz, must have only one of them'),
    (('column: stamp, unit: ms', 'rate_hz: 0'), 'time.rate_hz = 0, must be > 0'),
    (('delay_ms', 'delay'), 'map.yaml: signals.position: delay is unknown; the key is delay_ms'),
    (('{column: stamp, unit: ms}', '3'), 'map.yaml: time = 3, must be a section'),
    (('unit: ms', 'unit: [ms]'), "map.yaml: time.unit = ['ms'], must be one of s, ms, us"),
    (('unit: ms', 'unit: {a: b}'), "map.yaml: time.unit = {'a': 'b'}, must be one of s, ms"),
    (('column: 3', 'column: [x]'), "map.yaml: signals.position.column = ['x'], must be a name"),
    (('column: 3', 'column: 3.0'), 'map.yaml: signals.position.column = 3.0, must be a name, or'),
    (('column: 3', 'column: true'), 'map.yaml: signals.position.column = True, must be a name'),
    (('column: 3', 'column: null'), 'map.yaml: signals.position.column = None, must be a name'),
    (('column: stamp', 'column: [t]'), "map.yaml: time.column = ['t'], must be a name"),
    (('column: stamp', 'column: true'), 'map.yaml: time.column = True, must be a name, or'),
    (('sign: -1', 'sign: true'), 'map.yaml: signals.position.sign = True, must be 1 or -1'),
    (('ppm: 40', 'ppm: -1.0e+6'), 'map.yaml: clock_ppm = -1e+06, must be -100000 to 100000'),
    (('ppm: 40', 'ppm: 100001'), 'map.yaml: clock_ppm = 100001, must be -100000 to 100000'),
])
def test_a_mistake_is_one_line_with_its_place(
        tmp_path: Path, change: tuple[str, str], expected: str) -> None:
    assert change[0] in GOOD
    with pytest.raises(ConfigError) as refused:
        mapping(tmp_path, GOOD.replace(*change))
    assert expected in str(refused.value)


SLOPE = """
signals:
  position_command: {column: 1, unit: mm}
  velocity_command: {from: position_command}
"""


def test_the_velocity_may_be_the_slope_of_the_position(tmp_path: Path) -> None:
    own = mapping(tmp_path, SLOPE)
    assert own.has_slope and [*own.signals] == ['position_command']
    assert not mapping(tmp_path).has_slope


@pytest.mark.parametrize('change, expected', [
    (('from: position_command', 'from: position'), 'map.yaml: signals.velocity_command: must be '
     '{from: position_command} without other keys, or a signal'),
    (('from: position_command', 'from: position_command, unit: m'), 'must be {from: position_com'),
    (('  position_command: {column: 1, unit: mm}\n', ''),
     'map.yaml: signals.velocity_command: from = position_command, which is not mapped'),
    (('{column: 1, unit: mm}', '{from: velocity_command}'),
     'map.yaml: signals.position_command: from is unknown')])
def test_nothing_else_is_made_from_another_signal(
        tmp_path: Path, change: tuple[str, str], expected: str) -> None:
    assert change[0] in SLOPE
    with pytest.raises(ConfigError) as refused:
        mapping(tmp_path, SLOPE.replace(*change))
    assert expected in str(refused.value)


def test_without_signals_the_quantities_are_named(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match='lacks signals, by quantity: position, velocity, '):
        mapping(tmp_path, 'skip_lines: 3\n')


@pytest.mark.parametrize('ppm', [-1e5, 1e5])
def test_a_clock_may_be_wrong_by_a_tenth(tmp_path: Path, ppm: float) -> None:
    own = mapping(tmp_path, GOOD.replace('clock_ppm: 40', f'clock_ppm: {ppm:.1f}'))
    assert own.clock == pytest.approx(ppm * 1e-6, rel=1e-12, abs=0.0)


@pytest.mark.parametrize('unit, quantity, is_rotary, scale', [
    ('mm', 'position', False, 1e-3), ('deg', 'position', True, 0.017453292519943295),
    ('bar', 'pressure_a', False, 1e5), ('psi', 'pressure_b', True, 6894.757293168),
    ('lbf', 'force', False, 4.4482216152605), ('in', 'position', False, 0.0254),
    ('mA', 'current_command', False, 1e-3), ('Nm', 'force', True, 1.0),
    ('mm/s', 'velocity', False, 1e-3), ('kN', 'force', False, 1e3)])
def test_units_are_exact(unit: str, quantity: str, is_rotary: bool, scale: float) -> None:
    assert scale_of(unit, QUANTITIES[quantity], is_rotary, '') == pytest.approx(
        scale, rel=1e-15, abs=0.0)


def test_a_unit_of_another_quantity_is_refused() -> None:
    with pytest.raises(ConfigError, match=r"x: unit = 'mm', must be one of Pa, MPa, kPa, bar"):
        scale_of('mm', QUANTITIES['pressure_a'], False, 'x')
    with pytest.raises(ConfigError, match='must be one of rad, deg'):
        scale_of('mm', QUANTITIES['position'], True, 'x')
