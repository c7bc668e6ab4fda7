"""The proportional valve of `rig_proportional.yaml`, with and without its overlap compensated."""

from isa_ros import load
import numpy as np
import pytest

MILLI = 1e-3
MOVING, AT_REST = slice(1500, 4500), slice(6000, None)      # ms


def errors(**changes):
    """Return rms error of the sine, mean error at rest and swing at rest of both cylinders, mm."""
    by_key = {f'actuators.{name}.parameters.reu.position.{key}': value
              for name in ('plain', 'compensated') for key, value in changes.items()}
    result = load('rig_proportional', 'proportional', changes=by_key).simulate()
    assert result.trips == []
    found = []
    for name in ('plain', 'compensated'):
        error = (result[f'{name}.position'] - result[f'{name}.position_reference']) / MILLI
        found.append((float(np.std(error[MOVING])), float(np.abs(error[AT_REST]).mean()),
                      float(np.ptp(error[AT_REST]))))
    return found


@pytest.mark.slow
def test_the_compensated_cylinder_follows_and_rests_where_it_should():
    """As docs/parts.md has it: 14.1 and 5.7 mm, 12.5 and 0.26 mm; it rests below e/K_p."""
    plain, compensated = errors()
    assert plain[0] == pytest.approx(14.1, abs=0.1)
    assert compensated[0] == pytest.approx(5.7, abs=0.1)
    assert plain[1] == pytest.approx(12.5, abs=0.1)
    assert compensated[1] < 4e-5 / 0.0802 / MILLI
    assert plain[2] < 0.02 and compensated[2] < 0.02       # neither hunts: no integral gain


@pytest.mark.slow
def test_with_an_integral_gain_it_hunts_a_sixth_as_far():
    """13.1 and 2.1 mm: what is left is the hysteresis, which the inverse does not know."""
    plain, compensated = errors(ki=0.2)
    assert 10.0 < plain[2] < 16.0
    assert 1.5 < compensated[2] < 2.5
