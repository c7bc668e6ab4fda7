"""The table of what happened, from signals whose values are known."""

import isa_ros
from isa_ros.analysis.report.key_figures import SETTLED, settling_time
from isa_ros.analysis.report.outcome import outcome
from isa_ros.analysis.signals.signals import signals_of
import numpy as np
import pytest


def test_an_exponential_settles_after_the_logarithm_of_its_band():
    """1 - exp(-t / tau) is within 2 % of its range from tau ln(1 / 0.02) on."""
    t, tau = np.arange(1001) * 1e-3, 0.05
    x = 1.0 - np.exp(-t / tau)
    band = SETTLED * np.ptp(x)
    expected = tau * np.log(1.0 / (band + 1.0 - x[-1]))
    assert settling_time(t, x) == pytest.approx(expected, abs=1e-3)  # the next sample


@pytest.mark.parametrize('x', [np.zeros(101), np.sin(np.arange(101.0))])
def test_what_does_not_move_or_moves_on_has_no_settling_time(x):
    assert settling_time(np.arange(101.0), x) is None


def test_it_has_the_extremes_of_each_actuator_and_of_the_ground():
    result = isa_ros.load('leg', 'drop').simulate(duration=0.3)
    lines = outcome(signals_of(result)).splitlines()
    knee = lines[3].split()
    assert [line.split()[0] for line in lines[1:]] == ['haa', 'hfe', 'kfe', 'ground:', 'settled:']
    assert lines[0].split() == ['from', 'to', 'peak', 'pressure,', 'MPa', 'settled,', 's', 'oil,',
                                'l']
    assert float(knee[1]) == pytest.approx(1e3 * result['kfe.position'].min(), abs=0.051)
    assert float(knee[4]) == pytest.approx(np.abs(result['kfe.force']).max(), rel=5e-3)
    assert float(knee[-1]) == pytest.approx(1e3 * result['kfe.supply_volume'][-1], abs=5.1e-4)
    ground = float(lines[4].split()[3])
    assert ground == pytest.approx(result['body.foot_force'][:, 2].max(), rel=5e-3)
