"""The step of one loop, from its trace."""

from isa_ros.actuator.sheet import ActuatorSheet
from isa_ros.analysis.response.loops import Loop, Unit
from isa_ros.analysis.response.step import evaluate
import numpy as np
import pytest
from tests.sheets import actuator_sheet

RATE, BEFORE, RISES = 1000.0, 20, 10


def loop(sheet: ActuatorSheet) -> Loop:
    """Return a loop of a position."""
    metre = Unit('m')
    return Loop(name='position', label='position', sheet=sheet, unit=metre, inward=None,
                inward_unit=metre, quantity='position', per_reference=1.0, rate_hz=RATE,
                amplitude=0.01, largest=0.1)


@pytest.mark.parametrize('start', [0.0, 0.05, -0.03])
def test_figures_count_from_where_the_step_begins(start: float) -> None:
    """A ramp of 10 ms of 10 mm, from any place: 8 ms from 10 to 90 %, no overshoot or error."""
    ramp = np.clip((np.arange(220) - BEFORE) / RISES, 0.0, 1.0)
    output = start + 0.01 * ramp
    trace = {'position': output, 'position_reference': np.where(ramp > 0.0, start + 0.01, start)}
    found = evaluate(loop(actuator_sheet('isa_v5')), trace, BEFORE, start, 0.01, RATE)
    assert found.t[BEFORE] == 0.0 and found.inward is None
    # the ramp's crossings interpolate differences of numbers of 0.06 m
    assert found.figures.rise_time == pytest.approx(8e-3, rel=1e-9)
    assert found.figures.overshoot == pytest.approx(0.0, abs=1e-12)
    assert found.figures.steady_error == pytest.approx(0.0, abs=1e-15)
