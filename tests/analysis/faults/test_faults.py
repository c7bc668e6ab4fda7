"""`isa faults`: what each fault of the catalogue does to a running rig."""

import json
from pathlib import Path

from isa_ros.analysis.faults import page
from isa_ros.analysis.faults.measure import END_S, FaultEffect, outcomes, STEP_S, VISIBLE
from isa_ros.analysis.faults.rigs import ABOUT
from isa_ros.cli.main import main
from isa_ros.config.models.fault_catalogue import fault_catalogue
from isa_ros.core.signals import CHANNELS
from isa_ros.errors import ConfigError
from isa_ros.text.json_file import write_tree
import pytest


@pytest.fixture(scope='module')
def found() -> dict[str, FaultEffect]:
    """Return the outcome of every fault."""
    return {own.fault.name: own for own in outcomes()}


def signals(own: FaultEffect) -> list[str]:
    return [one.signal for one in own.visible]


def test_every_fault_has_an_outcome_and_none_breaks_the_simulation(found):
    assert list(found) == list(fault_catalogue())
    assert not [own for own in found.values() if own.diverged]


def test_a_fault_that_is_not_seen_says_why_and_no_other_does(found):
    unseen = {name for name, own in found.items() if not own.visible}
    assert unseen == {name for name, own in fault_catalogue().items() if own.unseen}


def test_a_fault_that_the_device_does_not_report_says_why_and_no_other_does(found):
    unreported = {name for name, own in found.items() if not own.noticed}
    assert unreported == {
        name for name, own in fault_catalogue().items() if own.unseen or own.unreported}


def test_what_is_seen_is_in_order_and_while_the_fault_lasts(found):
    for own in found.values():
        times = [one.after_s for one in own.visible]
        assert times == sorted(times) and all(0.0 < t < END_S for t in times)
        assert all(one.largest != 0.0 for one in own.visible)


@pytest.mark.parametrize(('name', 'signal', 'is_more'), [
    ('supply_low', 'supply pressure', False), ('pump_trip', 'supply pressure', False),
    ('supply_hose_leaks', 'supply pressure', False),
    ('return_blocked', 'pressure_a', True), ('relief_stuck_open', 'pressure_b', False),
    ('external_leak_b', 'pressure_b', False)])
def test_a_pressure_changes_in_the_direction_of_its_cause(found, name, signal, is_more):
    own = next(one for one in found[name].visible if one.signal == signal)
    assert own.unit == 'Pa' and (own.largest > 0.0) == is_more


def test_an_actuator_is_sound_again_after_each_fault_that_trips_nothing(found):
    """Within the second that is left of the run; a trip is kept until it is cleared."""
    assert [name for name, own in found.items() if own.recovered_s is None and not any(
        one.kind == 'trip' for one in own.noticed) and not own.fault.rig] == []
    assert found['coil_open'].recovered_s == 0.0 < found['valve_stuck'].recovered_s


def test_a_low_supply_is_warned_of(found):
    """Half of the 22 MPa at which the relief valves open, below which the open one of 5 MPa is."""
    assert [(one.kind, one.name) for one in found['supply_relief_stuck_open'].noticed] == [
        ('warning', 'supply_low'), ('warning', 'force_error')]


def noticed(own: FaultEffect) -> dict[str, float]:
    """Return what the device itself reports, with the time of each in ms, rounded."""
    return {f'{one.kind} {one.name}': round(one.after_s * 1e3) for one in own.noticed}


@pytest.mark.parametrize('name', [
    'valve_stuck', 'coils_open', 'amplifier_weak', 'spool_sensor_stuck'])
def test_a_spool_that_does_not_follow_is_reported_and_stops_the_actuator(found, name):
    """51 ms after it begins to deviate, which the motion decides."""
    own = noticed(found[name])
    assert set(own) >= {'trip spool_deviation', 'state fault'}
    assert 51 <= own['trip spool_deviation'] <= 200
    assert own['state fault'] == own['trip spool_deviation']


def test_a_shifted_null_is_a_warning(found):
    assert set(noticed(found['null_shift'])) == {'warning spool_deviation'}


def test_the_words_of_diagnostics_are_those_of_the_gravest_level(found):
    """A fault with its cause, else a warning; nothing if the device does not notice."""
    for own in found.values():
        kinds = {one.kind for one in own.noticed}
        assert own.message.startswith('fault: ') == ('state' in kinds)
        assert ('warning: ' in own.message) >= (kinds == {'warning'})
        assert bool(own.message) == bool(kinds)
    assert found['valve_stuck'].message == (
        'fault: spool deviation; disabled until ~/clear_fault, which needs its cause to be gone; '
        'warning: spool deviation')
    assert found['null_shift'].message == (
        'enabled, mode impedance: initialised; warning: spool deviation')


def test_table_list_page_and_json_have_every_fault(found, tmp_path, capsys):
    text, listed = page.as_text(list(found.values())), page.listing()
    write_tree(page.as_tree(list(found.values())), tmp_path / 'faults.json')
    path, = page.write_page(list(found.values()), tmp_path)
    tree = json.loads((tmp_path / 'faults.json').read_text())['faults']
    assert [one['name'] for one in tree] == list(found)
    for name, own in fault_catalogue().items():
        assert name in text and own.meaning in listed and f'`{name}`' in path.read_text()
        assert found[name].message in text and found[name].message in path.read_text()
        assert all(key in listed for key in own.values)
        assert all(f'parts.{own.part.upper()}.{key}: ' in listed for key in own.part_values)
    for rig, about in ABOUT.items():
        assert f'Faults of parts: {rig.replace("_", " ")}' in path.read_text()
        assert about in ' '.join(path.read_text().split())
    by_name = {one['name']: one for one in tree}
    assert (by_name['pump_worn']['part'], by_name['pump_worn']['part_set'], by_name[
        'pump_worn']['rig']) == ('pump', {'worn_lpm_per_mpa': 1.0}, 'circuit')
    assert f'{VISIBLE:g} steps' in path.read_text() and CHANNELS[0] in path.read_text()


def test_the_page_of_the_documentation_names_every_fault():
    text = (Path(__file__).parents[3] / 'docs' / 'device_faults.md').read_text()
    assert all(f'`{name}`' in text for name in fault_catalogue())


def test_a_list_needs_no_run_and_takes_no_other_option(capsys):
    assert main(['faults', '--list']) == 0
    assert 'plant.spool.stuck: 1' in capsys.readouterr().out
    assert main(['faults', '--list', '--only', 'valve_stuck']) == 2
    assert '--only is not used with --list' in capsys.readouterr().err


def test_an_unknown_fault_is_refused_in_one_line(capsys):
    with pytest.raises(ConfigError, match="--only = 'valve_stck' is unknown; did you mean valve"):
        outcomes(['valve_stck'])
    assert main(['faults', '--only', 'valve_stck']) == 2
    assert capsys.readouterr().err.count('\n') == 1


def test_a_time_is_a_whole_number_of_ticks(found):
    for own in found.values():
        for one in own.visible:
            assert one.after_s / STEP_S == pytest.approx(round(one.after_s / STEP_S), abs=1e-9)
