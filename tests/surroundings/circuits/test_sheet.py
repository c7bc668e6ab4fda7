"""What a circuit's parts refuse, and what its sheet says of them."""

from isa_ros.core.changeable import changeables, with_changes
from isa_ros.errors import ConfigError
import pytest
from tests.surroundings.circuits.sheets import sheet_of, SIMPLE
from tests.surroundings.circuits.station import STATION


@pytest.mark.parametrize(('text', 'said'), [
    (SIMPLE.replace('tank: {kind: tank}', 'reservoir: {kind: tank}\nother: {kind: tank}'),
     'parts has 2 tanks, must have one part of kind tank'),
    (SIMPLE.replace('tank: {kind: tank}\n', ''), 'parts has 0 tanks'),
    ('tank: {kind: tank}\n', 'parts lacks a pump'),
    (SIMPLE.replace('outlet: main', 'outlet: mian'),
     "parts.pump.outlet = 'mian', must be a manifold or the tank; did you mean main"),
    (SIMPLE.replace('outlet: main', 'outlet: tank'),
     "parts.pump.outlet = 'tank', must be another one than its inlet"),
    (SIMPLE + 'lone: {kind: manifold, oil_volume_l: 1.0}\n',
     'parts.lone: no part leads to this manifold'),
    (SIMPLE + 'a: {kind: accumulator, at: main, gas_volume_l: 1.0, precharge_mpa: 9.0}\n'
     'b: {kind: accumulator, at: main, gas_volume_l: 1.0, precharge_mpa: 9.0}\n',
     "parts.b.at = 'main', where a stands"),
    (SIMPLE + 'a: {kind: accumulator, at: tank, gas_volume_l: 1.0, precharge_mpa: 9.0}\n',
     "parts.a.at = 'tank', must be a manifold;"),
    (SIMPLE.replace('0.5}', '0.5, returns_to: drain}'), "parts.main.returns_to = 'drain'"),
    (SIMPLE.replace('0.5}', '0.5, returns_to: main}'),
     "parts.main.returns_to = 'main', must be another manifold or the tank"),
    (SIMPLE.replace('inlet: tank, outlet: main', 'inlet: main, outlet: tank'),
     "parts.pump.outlet = 'tank', must be the manifold that it feeds, of main"),
    (STATION.replace('inlet: gallery, outlet: stored', 'inlet: stored, outlet: gallery'),
     'parts.stored: no part leads oil to this manifold, which begins with it; oil flows from '
     'inlet to outlet'),
    (STATION.replace('shuts_mpa: 18.0', 'shuts_mpa: 20.0'),
     'shuts_mpa = 20 MPa, must be < opens_mpa = 19.5 MPa'),
    (SIMPLE.replace('main:', 'return:').replace('outlet: main', 'outlet: return'),
     "'return' is a word of Python, must be another name"),
    (SIMPLE.replace('main:', 'Main:'), 'Main: the name'),
    (SIMPLE + 'x: 3\n', 'station.yaml: parts.x = 3, must be a section'),
    (SIMPLE + 'mian: {oil_volume_l: 3.0}\n',
     'parts.mian lacks kind, one of tank, manifold, pump, accumulator, line, relief, check, '
     'filter, unloading, block, dump, cooler; did you mean main?'),
    (SIMPLE + 'x: {kind: turbine}\n', "x.kind = 'turbine', must be one of tank, manifold"),
    (SIMPLE.replace('outlet: main', 'outlet: 3'), 'parts.pump.outlet = 3, must be a name'),
    (SIMPLE.replace('speed_rpm: 1500.0', 'speed_rpm: -1.0'),
     r'parts.pump.speed_rpm = -1 rpm, must be >= 0 rpm')])
def test_what_is_no_circuit_is_refused(text: str, said: str) -> None:
    with pytest.raises(ConfigError) as refused:
        sheet_of(text)
    assert said in str(refused.value)


def test_the_return_side_is_between_where_actuators_return_and_the_tank() -> None:
    assert sheet_of(STATION).with_return() == {'drain'}
    longer = STATION.replace('strainer: {kind: filter, inlet: drain, outlet: tank', (
        'pipe: {kind: line, inlet: drain, outlet: sump, length_m: 1.0, bore_mm: 20.0}\n'
        'sump: {kind: manifold, oil_volume_l: 1.0}\n'
        'strainer: {kind: filter, inlet: sump, outlet: tank'))
    assert sheet_of(longer).with_return() == {'drain', 'sump'}
    assert sheet_of(SIMPLE).with_return() == set()


def test_its_pressure_is_that_of_the_highest_pump_above_the_tank() -> None:
    assert sheet_of(STATION).pressure_mpa == pytest.approx(20.2)
    assert sheet_of(STATION).return_pressure_mpa == 0.2
    assert sheet_of(STATION).is_switched and not sheet_of(SIMPLE).is_switched


@pytest.mark.parametrize(('old', 'new', 'expected'), [
    ('', '', 19.5),                                     # its unloading valve, of a gauge pressure
    ('opens_mpa: 22.0', 'opens_mpa: 15.0', 15.2),       # its relief valve, above the tank's
    ('opens_mpa: 19.5', 'opens_mpa: 20.3', 20.2)])      # its pump, above the tank's
def test_at_rest_it_is_at_the_least_of_what_pump_and_valves_hold(
        old: str, new: str, expected: float) -> None:
    assert sheet_of(STATION.replace(old, new)).rest_pressure == pytest.approx(
        1e6 * expected, rel=1e-12)


def test_faults_and_set_points_have_the_part_in_their_keys() -> None:
    sheet = sheet_of(STATION)
    known = changeables(sheet, 'station.')
    faults = {key.removeprefix('station.') for key in known}
    assert {'parts.hose.burst', 'parts.buffer.gas_lost', 'parts.safety.spring_broken',
            'parts.pump.stuck', 'parts.pump.speed_rpm', 'parts.kept.stuck_open',
            'parts.strainer.clogged', 'dump.opened'} <= faults
    changed = with_changes(sheet, known, {'station.parts.hose.burst': 0.5})
    assert changed.by_name['hose'].burst == 0.5
    assert changed.by_name['pump'] == sheet.by_name['pump']
    assert sheet_of(STATION) == sheet
