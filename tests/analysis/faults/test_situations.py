"""Which fault is noticed in which situation, and what it costs where none is."""

from isa_ros.analysis.faults.situations import (
    as_text, as_tree, first_alarm, SITUATIONS, situations, write_page)
from isa_ros.cli.main import main
from isa_ros.core.conditions import BITS
from isa_ros.errors import ConfigError
import numpy as np
import pytest


@pytest.fixture(scope='module')
def found():
    return {(own.fault, own.situation): own
            for own in situations(['pressures_lost', 'relief_stuck_open', 'encoder_stuck'])}


def test_a_broken_wire_is_noticed_in_every_situation(found):
    """2 ms of delay, and the tick in which they end."""
    for name in SITUATIONS:
        own = found['pressures_lost', name]
        assert (own.condition, own.kind) == ('sensor_range', 'trip')
        assert own.after_s == pytest.approx(3e-3, abs=1e-9)


def test_a_fault_of_a_part_is_refused():
    with pytest.raises(ConfigError, match="--only = 'pump_worn' is a fault of a part, which no"):
        situations(['pump_worn'])


def test_open_relief_valves_are_noticed_where_force_is_needed(found):
    assert found['relief_stuck_open', 'at rest'].condition == ''
    for name in ('fast', 'blocked force'):
        assert found['relief_stuck_open', name].condition == 'force_error'
    fast = found['relief_stuck_open', 'fast']
    assert fast.position_error > 0.05 > 0.001 > found[
        'relief_stuck_open', 'at rest'].position_error


def test_errors_are_those_of_the_piston(found):
    """A stuck encoder shows the motion of 20 mm at most; the piston goes to an end, 50 mm away."""
    assert found['encoder_stuck', 'slow'].position_error > 0.045


@pytest.mark.parametrize(('warns_at', 'first'), [
    (520, ('overspeed', 'trip', 20e-3)), (519, ('overload', 'warning', 19e-3))])
def test_the_first_alarm_counts_and_of_one_tick_the_trip(warns_at, first):
    """The sound run has a warning of its own all the time, which is none of the fault."""
    sound = {'warnings': np.full(600, float(1 << BITS['relief_open'])), 'trips': np.zeros(600)}
    faulty = {name: values.copy() for name, values in sound.items()}
    faulty['warnings'][warns_at:] += 1 << BITS['overload']
    faulty['trips'][520:] += 1 << BITS['overspeed']
    name, kind, after_s = first_alarm(faulty, sound)
    assert (name, kind, pytest.approx(after_s, abs=1e-9)) == first


def test_the_matrix_has_a_row_a_fault_and_a_column_a_situation(found, tmp_path):
    head, *rows = as_text(list(found.values())).splitlines()
    assert all(name in head for name in SITUATIONS) and len(rows) == 3
    assert len(as_tree(list(found.values()))['situations']) == 12
    page, = write_page(list(found.values()), tmp_path)
    assert 'trip sensor_range, 3 ms' in page.read_text()
    own = found['encoder_stuck', 'slow']
    assert f'; {own.position_error * 1e3:.3g} mm, {own.force_error:.0f} N |' in page.read_text()


def test_an_unknown_fault_and_options_that_do_not_fit_are_refused(capsys):
    with pytest.raises(ConfigError, match='valve_stck'):
        situations(['valve_stck'])
    assert main(['faults', '--list', '--situations']) == 2
    assert '--situations is not used with --list' in capsys.readouterr().err
