"""Errors of position and force that faults cause, whatever the sensors read."""

from isa_ros.analysis.faults import page
from isa_ros.analysis.faults.measure import FaultEffect, outcomes
import pytest

NAMES = ['encoder_stuck', 'load_cell_offset', 'pressure_a_noisy', 'reu_frozen']


@pytest.fixture(scope='module')
def found() -> dict[str, FaultEffect]:
    """Return the outcomes of a few faults."""
    return {own.fault.name: own for own in outcomes(NAMES)}


def test_errors_are_those_of_the_piston_and_not_of_what_the_sensors_read(found):
    """
    A stuck encoder reads what it read: the reading differs by the motion of 20 mm at most.

    The loops drive the piston into the end of its stroke meanwhile, 50 mm away. A load cell that
    reads 1000 N too much makes the loops push by as much less.
    """
    stuck = found['encoder_stuck']
    assert stuck.position_error > 0.05
    assert all(abs(one.largest) < 0.041 for one in stuck.visible if one.signal == 'position')
    offset, read = found['load_cell_offset'], 1000.0
    assert 0.5 * read < offset.force_error < read
    assert [one.largest > read for one in offset.visible if one.signal == 'force'] == [True]


def test_a_fault_costs_what_the_sound_run_has_not_while_it_lasts(found):
    """A noisy sensor of a pressure that no loop uses moves nothing; a frozen program stands."""
    assert found['pressure_a_noisy'].position_error == 0.0 == found['pressure_a_noisy'].force_error
    assert 0.02 < found['reu_frozen'].position_error < 0.041


def test_table_and_json_have_them(found):
    own = found['load_cell_offset']
    tree = page.as_tree([own])['faults'][0]
    assert (tree['position_error'], tree['force_error']) == (own.position_error, own.force_error)
    cells = dict(zip(page.HEADER, page._cells(own)))
    assert float(cells['position error, mm']) == pytest.approx(own.position_error * 1e3, rel=5e-3)
    assert float(cells['force error, N']) == pytest.approx(own.force_error, abs=0.5)


def test_what_the_device_has_kept_is_cleared_and_it_is_enabled_again(found):
    """It is sound again within the second that is left, which a disabled one is not."""
    recovered = found['reu_frozen'].recovered_s
    assert recovered is not None and 0.1 < recovered < 1.0
