"""Requests of controllers beyond the range of their actuator, at every tick."""

from isa_ros.actuator.request_range import RequestRange
from isa_ros.actuator.setpoint_range import SetpointRange
from isa_ros.core.device import SPOOL
from isa_ros.core.signals import COMMAND, HAS_ENABLE, HAS_GAINS, HAS_REFERENCE
import numpy as np
import pytest
from tests.actuator.test_setpoint_range import reference
from tests.sheets import actuator_sheet, setpoint


def request_range(beyond: str | None = None) -> RequestRange:
    """Return the range of the requests to a rotor and a knee."""
    return RequestRange([
        SetpointRange('hip', actuator_sheet('smart_manifold')),
        SetpointRange('knee', actuator_sheet('isa_v5'), beyond)])


def requests_to_the_knee(**values: float) -> np.ndarray:
    rows = np.zeros(2, COMMAND)
    rows[1] = setpoint(**values)
    return rows


def test_a_request_beyond_the_range_is_deleted_as_a_whole():
    rows = requests_to_the_knee(position=50.0)
    rows['kinds'][1] |= HAS_ENABLE
    rows[0] = setpoint(position=1.0)
    hip = rows[0].tobytes()
    line, = request_range().admit(12_000_000, rows)
    assert line.startswith("a controller's request, refused: knee: setpoint position = 50 m, must "
                           'be 0 to 0.1 m, the stroke; ')
    assert rows[1].tobytes() == bytes(COMMAND.itemsize) and rows[0].tobytes() == hip


def test_a_request_is_limited_where_configured():
    rows = requests_to_the_knee(position=0.05, effort=1e5)
    line, = request_range('limit').admit(0, rows)
    assert line.endswith('knee: setpoint effort = 100000 N, limited to 7500 N, the rated force')
    assert rows['effort'].tolist() == [0.0, 7500.0] and rows['position'][1] == 0.05


@pytest.mark.parametrize('field', ['position', 'effort', 'stiffness', 'damping'])
def test_each_field_with_a_range_is_noticed(field):
    """At both bounds it is admitted, unchanged; one step of a double beyond it is not."""
    low, high, _, _ = SetpointRange('knee', actuator_sheet('isa_v5')).bounds[field]
    for value, away in ((low, -np.inf), (high, np.inf)):
        rows = requests_to_the_knee(**{'position': 0.05, field: value})
        before = rows.tobytes()
        assert request_range().admit(0, rows) == () and rows.tobytes() == before
        rows[field][1] = np.nextafter(value, away)
        assert len(request_range().admit(0, rows)) == 1 and rows['kinds'][1] == 0


def test_reports_of_one_actuator_are_a_second_apart():
    own, ticks = request_range(), []
    for tick in range(2500):
        if own.admit(tick * 1_000_000, requests_to_the_knee(position=50.0)):
            ticks.append(tick)
    assert ticks == [0, 1000, 2000]


def test_a_request_with_a_mode_is_checked_too():
    """Of a reference the range; the mode in force is that of the actuator."""
    rows = np.zeros(2, COMMAND)
    rows[1] = reference(SPOOL, 1e-3)
    line, = request_range().admit(0, rows)
    assert 'refused: knee: setpoint spool = 0.001 m, must be' in line and rows['kinds'][1] == 0
    rows[1] = reference(SPOOL, 1e-5)
    assert request_range().admit(0, rows) == () and rows['kinds'][1] == HAS_REFERENCE


def test_gains_alone_beyond_the_range_are_deleted_too():
    """Their position and effort are not looked at: the command does not have them."""
    rows = requests_to_the_knee(position=50.0, stiffness=1e12)
    rows['kinds'][1] = HAS_GAINS
    line, = request_range().admit(0, rows)
    assert 'knee: setpoint stiffness = 1e+12 N/m, must be 0 to' in line and not rows['kinds'][1]
    rows = requests_to_the_knee(position=50.0, stiffness=1e4)
    rows['kinds'][1] = HAS_GAINS
    assert request_range().admit(0, rows) == () and rows['kinds'][1] == HAS_GAINS
