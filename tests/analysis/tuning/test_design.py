"""Gains for a known plant: the loop with them has the wanted margin and bandwidth."""

from dataclasses import replace
import math

from isa_ros.analysis.signals.frequency import bandwidth, margins, Response
from isa_ros.analysis.tuning.block_response import parts, responses
from isa_ros.analysis.tuning.design import (
    DENSE, designed, Gains, LEAST_GAIN_MARGIN, LoopAtPlace, Plant, plant_of, shares, WantedLoop)
from isa_ros.reu.block import Pid
import numpy as np
import pytest
from tests.sheets import actuator_sheet

FREQUENCY = np.geomspace(4.0, 400.0, DENSE)
GAIN = 1.5e9    # force per demand and second, that of the ISA v5 about


def force_block() -> Pid:
    """Return the force block of the ISA v5."""
    block = actuator_sheet('isa_v5').reu.force
    assert isinstance(block, Pid)
    return block


def plant(gain: float, lag_hz: float = 100.0) -> Plant:
    """Return an integrator behind a lag, and the hold of the samples."""
    s = 2j * math.pi * FREQUENCY
    return Plant(FREQUENCY, gain / s / (1.0 + s / (2.0 * math.pi * lag_hz)) * np.exp(-2e-4 * s))


def places(*plants: Plant) -> list[LoopAtPlace]:
    """Return the loops of some plants with the ISA v5's block."""
    of_block = parts(force_block(), FREQUENCY)
    return [LoopAtPlace(own, *of_block, FREQUENCY) for own in plants]


def measured(value: np.ndarray) -> Response:
    """Return a response that is exact."""
    ones = np.ones(len(value))
    return Response(FREQUENCY, value, ones, ones, ones)


@pytest.mark.parametrize('wanted', [
    WantedLoop(60.0, 40.0), WantedLoop(45.0, 40.0), WantedLoop(70.0, 25.0),
    WantedLoop(55.0, 60.0)])
def test_the_designed_loop_is_as_wanted(wanted):
    """Computed again from the responses of the block with these gains, not from its parts."""
    plants = [plant(GAIN), plant(3.0 * GAIN)]
    gains = designed(places(*plants), wanted, [8e-8, 8e-8])
    assert gains is not None
    for own, kp in zip(plants, gains.kp):
        of_reference, of_measured = responses(
            _with(kp, gains.corner * kp, gains.kf), FREQUENCY)
        closed = own.value * of_reference / (1.0 + own.value * of_measured)
        opened = margins(measured(closed / (1.0 - closed)))
        # The search ends within 0.4 of 5 deg; a bandwidth is shared in steps of 1 % of K_p.
        assert opened.phase == pytest.approx(wanted.phase_margin, abs=2.1)
        assert bandwidth(measured(closed), 1.0) == pytest.approx(wanted.bandwidth, rel=0.025)
        for gain in (opened.gain_db, margins(measured(own.value * of_measured)).gain_db):
            assert gain is None or gain >= LEAST_GAIN_MARGIN - 0.1


def _with(kp: float, ki: float, kf: float) -> Pid:
    return replace(force_block(), kp=kp, ki=ki, kf=kf)


def test_a_plant_of_thrice_the_gain_has_a_third_of_the_gains():
    """L is the same: nothing but the product counts."""
    gains = designed(places(plant(GAIN), plant(3.0 * GAIN)), WantedLoop(60.0, 40.0), [8e-8, 3e-8])
    assert gains is not None
    assert gains.kp[0] / gains.kp[1] == pytest.approx(3.0, rel=1e-3)


def test_a_bandwidth_far_beyond_the_valve_has_no_robust_gains():
    """A lag of 20 Hz and a delay: at 200 Hz the phase is beyond -180 deg, whatever the lead."""
    assert designed(places(plant(GAIN, lag_hz=20.0)), WantedLoop(60.0, 200.0), [8e-8]) is None


def test_the_plant_comes_back_from_the_closed_loop():
    """P = T / (C_r - T C_y), with the block that T was measured with; without untrusted points."""
    own, block = plant(GAIN), force_block()
    of_reference, of_measured = responses(block, FREQUENCY, 0.5)
    closed = own.value * of_reference / (1.0 + own.value * of_measured)
    coherence = np.ones(DENSE)
    coherence[7] = 0.3
    found = plant_of(Response(FREQUENCY, closed, coherence, coherence, coherence),
                     of_reference, of_measured)
    kept = np.delete(np.arange(DENSE), 7)
    # T is 1e-2 at the end of the band: rounding there is a hundred times larger in P
    assert found.value == pytest.approx(own.value[kept], rel=1e-12, abs=0.0)
    # Between its points too: one is missing of 240 in two decades
    assert found.at(FREQUENCY[7:8]) == pytest.approx(own.value[7:8], rel=1e-4, abs=0.0)


def test_errors_are_shares_of_what_is_tolerated():
    assert shares(WantedLoop(60.0, 40.0), 55.0, 42.0) == pytest.approx((-1.0, 0.5))


def test_gains_hold_one_kp_for_each_place():
    gains = designed(places(*[plant(GAIN * k) for k in (1.0, 2.0, 4.0)]), WantedLoop(60.0, 40.0),
                     [8e-8] * 3)
    assert isinstance(gains, Gains) and gains.kp.shape == (3,)
