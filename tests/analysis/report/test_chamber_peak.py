"""The pressures of the key figures: of the sensors, and of a chamber behind a hose."""

from collections.abc import Mapping

import isa_ros
from isa_ros.analysis.report.key_figures import key_rows, pressure_range
from isa_ros.analysis.signals.signals import Signal, Signals
import numpy as np
import pytest

SENSED = {'pressure_a': [0.2, 17.3], 'pressure_b': [4.1, 3.0]}


def signals(name: str, fields: Mapping[str, list[float]]) -> Signals:
    """Return the signals of the only actuator of a run; ``fields`` in MPa."""
    run = isa_ros.load(name).configuration
    t = np.array([0.0, 0.001])
    own = run.actuators[0].name
    return Signals(run, {f'{own}.{field}': Signal(t, 1e6 * np.array(values))
                         for field, values in fields.items()}, t, 'test')


@pytest.mark.parametrize(('chambers', 'expected'), [
    ({'chamber_pressure_a': [0.2, 17.1], 'chamber_pressure_b': [23.8, 3.0]},
     '0.2 to 17.3, chamber 23.8'),
    ({'chamber_pressure_a': [0.2, 17.34], 'chamber_pressure_b': [4.1, 3.0]}, '0.2 to 17.3'),
    ({'chamber_pressure_a': [0.2, 12.0], 'chamber_pressure_b': [4.1, 3.0]}, '0.2 to 17.3'),
    ({}, '0.2 to 17.3')])
def test_behind_hoses_a_higher_chamber_is_named(
        chambers: dict[str, list[float]], expected: str) -> None:
    found = signals('rig_counterbalance', {**SENSED, **chambers})
    assert pressure_range(found, found.run.actuators[0]) == expected
    assert expected in key_rows(found)[1]


def test_without_hoses_the_sensors_are_at_the_chambers() -> None:
    found = signals('rig_linear', {**SENSED, 'chamber_pressure_a': [0.2, 23.8]})
    assert pressure_range(found, found.run.actuators[0]) == '0.2 to 17.3'


def test_nothing_recorded_has_no_range() -> None:
    found = signals('rig_counterbalance', {'chamber_pressure_a': [0.2, 23.8]})
    assert pressure_range(found, found.run.actuators[0]) == '-'
