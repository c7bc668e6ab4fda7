"""The study of a boom that is let down behind a counterbalance valve."""

from isa_ros.analysis.studies import lowering
import numpy as np
import pytest

TIME = np.arange(11001) * 1e-3


def outcome(pressure, position=TIME):
    return lowering.Lowering(
        lowering.LoweringCase(lowering.BY_POSITION, 1.5), TIME, position, TIME, pressure,
        2e6 + 1e5 * TIME, ())


def test_a_swing_has_the_rms_and_the_frequency_of_its_sine():
    """A sine of 0.2 MPa on a ramp of 1 MPa/s, beside a pendulum of 0.8 Hz: rms 0.2/sqrt(2)."""
    swinging = (8e6 + 1e6 * TIME + 2e5 * np.sin(2.0 * np.pi * 7.0 * TIME)
                + 3e5 * np.sin(2.0 * np.pi * 0.8 * TIME))
    rms, frequency = outcome(swinging).swing
    assert frequency == pytest.approx(7.0, abs=0.1)     # half a line: 0.5/5 s
    # the window's lines of 0.8 Hz are below 1e-3 of it from 2 Hz on
    assert rms == pytest.approx(2e5 / np.sqrt(2.0), rel=3e-3)


def test_error_speed_and_pilot_are_those_of_the_way_down():
    position = TIME.copy()
    position[7000] -= 3e-3
    position[9600] -= 5e-3
    own = outcome(np.full(len(TIME), 8e6), position)
    assert own.error == pytest.approx(3e-3)
    assert own.fastest == pytest.approx(2.0)            # -3 + 1 mm within 1 ms
    assert own.largest_pilot == pytest.approx(2e6 + 1e5 * 9.499)


@pytest.mark.slow
def test_a_small_ratio_lets_the_boom_down_and_a_soft_impedance_trips(tmp_path):
    """As docs/lowering.md has it."""
    ones = {case: lowering.outcome(case) for case in (*lowering.SHOWN, lowering.CASES[-1])}
    small, large, by_force, soft = ones.values()
    assert small.trips == large.trips == by_force.trips == ()
    assert soft.trips == ('force_error, 0.32 s',)
    assert small.error < 2e-3 < 4e-3 < large.error
    assert 0.038 < small.fastest < 0.045
    assert small.swing[0] < 0.02e6 < 0.1e6 < large.swing[0]
    assert 2.0 < large.swing[1] < 4.0
    assert by_force.swing[0] > 0.1e6 and 25.0 < by_force.swing[1] < 40.0
    calm = lowering.outcome(lowering.LoweringCase(lowering.BY_FORCE, 3.0, gain=0.5))
    assert calm.swing[0] < 0.01e6
    found = [*ones.values(), calm, *map(lowering.outcome, lowering.CASES[:1])]
    paths = lowering.STUDY.write_page(found, tmp_path)
    assert [path.name for path in paths] == ['lowering.md', 'lowering.png']
    assert 'force_error' in lowering.STUDY.as_text(found)
    assert [own['pilot_ratio'] for own in lowering.STUDY.as_tree(found)['outcomes']] == [
        1.5, 10.0, 3.0, 1.5, 3.0, 1.0]
