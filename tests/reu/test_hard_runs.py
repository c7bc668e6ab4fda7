"""Hard runs of a sound device: no condition trips, and none that judges the device warns."""

import warnings

import isa_ros
from isa_ros.core.conditions import BITS
import numpy as np
import pytest
from tests.reu.hard_runs import hard_runs, HardRun, IN_SHORT

RUNS = {run.name: run for run in hard_runs()}
OF_THE_DEVICE = sum(1 << BITS[name] for name in (
    'load_cell_implausible', 'encoder_jump', 'spool_deviation', 'sensor_range', 'position_error',
    'force_error', 'oscillation', 'runaway', 'watchdog'))
"""Bits that only a broken device may set; what is left warns of loads and of supplies."""


def alarms(run: HardRun) -> list[str]:
    """Return the trips of a run, and the conditions of the device that have warned."""
    ready = run.load()
    with warnings.catch_warnings():
        warnings.simplefilter('ignore')
        result = ready.simulate()
    found = [str(trip) for trip in result.trips]
    for name in ready.actuators:
        bits = np.bitwise_or.reduce(result[f'{name}.warnings'].astype(int))
        found += [f'{name}: {condition} warns'
                  for condition in isa_ros.conditions(float(bits & OF_THE_DEVICE))]
    return found


def test_there_are_as_many_as_are_promised() -> None:
    assert len(RUNS) == len(list(hard_runs())) >= 150
    assert IN_SHORT <= RUNS.keys()


@pytest.mark.parametrize('name', sorted(IN_SHORT))
def test_a_hard_run_gives_no_alarm(name: str) -> None:
    assert alarms(RUNS[name]) == []


@pytest.mark.long
def test_no_hard_run_gives_an_alarm() -> None:
    """All of them, about a minute and a half."""
    found = {name: own for name, run in RUNS.items() if (own := alarms(run))}
    assert found == {}
