"""When the device reports each fault of the catalogue, read from the bag of a run with it."""

from collections.abc import Mapping
from pathlib import Path

from diagnostic_msgs.msg import DiagnosticStatus
from isa_ros.analysis.faults.measure import BEGIN_S
from isa_ros.analysis.faults.rigs import CONFIG, LINK, MOTION
from isa_ros.bag.reader import Bag
from isa_ros.config.models.fault_catalogue import ACTUATOR, common_faults
from isa_ros.core.conditions import conditions
from isa_ros.scripting.result import Result
from isa_ros.scripting.run import load
from msg_adapters.cdr_reader import decode
import numpy as np
import pytest

pytestmark = pytest.mark.slow
DURATION_S = 1.05
DELAY = 51      # ms to the sample after 50 ms of conversions and one more
REPORTED: Mapping[str, tuple[str, int]] = {
    'valve_stuck': ('spool deviation', 101),        # once the motion needs another opening
    'null_shift': ('spool deviation', DELAY + 1),   # the spool needs 1 ms to get there
    'coils_open': ('spool deviation', 85),          # when the motion needs the other direction
    'coil_shorted': ('spool deviation', DELAY + 1),
    'amplifier_weak': ('spool deviation', 84),
    'relief_stuck_open': ('force error', 283),      # once the motion needs more than they hold
    'reu_frozen': ('watchdog', 6),
    'supply_relief_stuck_open': ('supply low', 82),     # 11 MPa, and 10 ms
    'encoder_stuck': ('force error', 104),          # the loop pushes to the other end
    'load_cell_offset': ('load cell implausible', DELAY),
    'load_cell_late': ('oscillation', 199), 'load_cell_reversed': ('oscillation', 166),
    'pressure_a_lost': ('load cell implausible', DELAY), 'pressures_lost': ('sensor range', 3),
    'supply_sensor_lost': ('sensor range', 3), 'spool_sensor_stuck': ('spool deviation', 102)}
"""First condition that the device warns of or trips, and ms from the begin of the fault."""
UNREPORTED = [name for name, own in common_faults().items() if own.unreported or own.unseen]


def result_of(name: str) -> Result:
    """Return a run with a fault, behind a link if it is one of it."""
    fault = common_faults()[name]
    has_link = any(key.startswith('link.') for key in fault.values)
    run = load({**CONFIG, 'link': LINK} if has_link else CONFIG, MOTION)
    return run.simulate(DURATION_S, faults=[{
        't_s': BEGIN_S, fault.of: 'ram' if fault.of == ACTUATOR else 'supply', 'fault': name,
        'until_s': 1.0}])


def reported(name: str, directory: Path) -> tuple[str, int] | None:
    """Return the first condition on ``~/device`` that is not OK, and when; None: there is none."""
    for message in Bag(result_of(name).save(directory / name)).messages():
        if message.topic == '/ram/device':
            status = decode(message.data, DiagnosticStatus)
            if status.level != DiagnosticStatus.OK:
                told = {pair.key: pair.value for pair in status.values}
                return (told['faults'] or told['warnings'],
                        round((float(told['since_s']) - BEGIN_S) * 1e3 + 0.5))
    return None


def test_every_fault_is_reported_or_there_is_a_reason() -> None:
    """A lost link takes the reports with it: it is detected by their age."""
    assert sorted([*REPORTED, *UNREPORTED, 'link_lost']) == sorted(common_faults())


@pytest.mark.parametrize('name', REPORTED)
def test_a_fault_is_reported_in_time(name: str, tmp_path: Path) -> None:
    assert reported(name, tmp_path) == REPORTED[name]


@pytest.mark.parametrize('name', [*UNREPORTED, 'link_lost'])
def test_a_fault_that_cannot_be_detected_is_not_reported(name: str, tmp_path: Path) -> None:
    assert reported(name, tmp_path) is None


def test_a_lost_link_is_detected_on_both_of_its_ends() -> None:
    """By the device after its watchdog of 10 ms; by a listener as the age of what it has."""
    result = result_of('link_lost')
    begin, tripped = round(BEGIN_S * 1e3), np.flatnonzero(result['ram.trips'])
    assert conditions(float(result['ram.trips'][tripped[0]])) == ['link_lost']
    assert tripped[0] - begin == 11
    age = result['ram.link.age']
    assert age[:begin].max() < 0.0021 < 0.01 < age[begin + 12] and age[1000] > 0.49
