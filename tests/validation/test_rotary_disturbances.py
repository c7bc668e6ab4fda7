"""Results of the checks under disturbances: impacts, their spikes, the blocked weight."""

from dataclasses import replace
import math

from isa_ros.config.paths import CONFIG, find
from isa_ros.config.runs.run_file import load_run
from isa_ros.core.constants import STANDARD_GRAVITY
from isa_ros.core.signals import COMMAND, SAMPLE
from isa_ros.scenario.scenario import idle
from isa_ros.scripting.result import Log, Result
from isa_ros.surroundings.supply_sample import SUPPLY_SAMPLE
from isa_ros.validation.rotary_disturbances import (
    blocked_peak, dropped, fall_time, Impact, impacts, onsets)
import numpy as np
import pytest
from tests.sheets import own_load

DROP = own_load('smart_manifold', 'drop_rig')


def result_of(load=None, stiffness: float = 0.0, **signals: np.ndarray) -> Result:
    """Return an artificial result of the rotary rig, on its wheel or another load, 1 ms apart."""
    run = load_run(find('rig_rotary', CONFIG))
    if load is not None:
        run = replace(run, actuators=(replace(run.actuators[0], load=load),))
    n = len(next(iter(signals.values())))
    samples, applied = np.zeros((n, 1), SAMPLE), np.zeros(1, COMMAND)
    for name, values in signals.items():
        samples[name][:, 0] = values
    applied['stiffness'] = stiffness
    supplies = np.zeros((n, 1), SUPPLY_SAMPLE)
    log = Log(samples, supplies, {}, {0: np.zeros(1, COMMAND), 5: applied})
    return Result(idle(run), log, {})


def test_a_rebound_is_no_impact_of_its_own():
    """Contacts 0.06 s apart are one, those 0.5 s apart are two; one at the start is none."""
    t = np.arange(1000) * 1e-3
    begins = np.array([0, 300, 380, 900])
    touching = np.zeros(1000, bool)
    touching[begins[:, None] + np.arange(20)] = True
    assert onsets(t, touching) == [300, 900]
    assert onsets(t, np.zeros(1000, bool)) == []


def test_a_spike_is_told_by_what_makes_it():
    """
    The wheel stops at once at the stop: 20 Nms/rad times 3 rad/s, 300 Nm/rad unchanged.

    Before, it is 0.05 rad ahead at the speed of its setpoint: -15 Nm. After, the reference is
    -15 + 60 Nm, all of it from the velocity.
    """
    load = load_run(find('rig_rotary', CONFIG)).actuators[0].load
    t = np.arange(1000) * 1e-3
    angle = np.minimum(load.stop_high + 1e-3, load.stop_high + 3.0 * (t - 0.5))
    goal = angle - 0.05
    torque = 300.0 * (goal - angle) + np.where(t > 0.5005, 20.0 * 3.0, 0.0)  # from 0.501 s on
    hit, = impacts(result_of(
        stiffness=300.0, position=angle, position_reference=goal, force_reference=torque))
    assert hit == Impact(pytest.approx(15.0), pytest.approx(45.0), pytest.approx(100.0))


def test_the_weight_is_timed_from_when_the_rope_is_taut():
    """A deflection exp(-t/0.1 s) short of 30 mrad is within 5 % after 0.1 s ln 20."""
    t = np.arange(2000) * 1e-3
    taut = DROP.release_s + fall_time(DROP)
    assert 0.5 * STANDARD_GRAVITY * fall_time(DROP) ** 2 == pytest.approx(DROP.slack)
    turned = np.where(t < taut, 0.0, 0.03 * (1.0 - np.exp(-(t - taut) / 0.1)))
    torque = np.where(t < taut, 0.0, 80.0 * np.exp(-(t - taut) / 0.1))
    found = dropped(result_of(DROP, position=0.9 - turned, force=-torque))
    # what is left of the exponential over the last 0.2 s: exp(-15)
    assert found.deflection == pytest.approx(0.03, rel=1e-6)
    # between two samples the curve bends by (dt/tau)^2/8 = 1.3e-5 of the band: 1.3e-6 s
    assert found.settling_time == pytest.approx(0.1 * math.log(20.0), abs=2e-6)
    assert found.peak == torque.max()


def test_the_blocked_weight_swings_on_its_rope():
    """
    Without damping R (m g + sqrt((m g)^2 + k m v^2)), v^2 = 2 g slack.

    A thousandth of half a period misses the peak by at most (pi/1000)^2/8 = 1.2e-6 of it.
    """
    load = replace(DROP, rope_damping=0.0)
    pull = load.weight_kg * STANDARD_GRAVITY
    swing = math.sqrt(pull * (pull + 2.0 * load.rope_stiffness * load.slack))
    assert blocked_peak(load) == pytest.approx(load.radius * (pull + swing), rel=1.3e-6)
    assert blocked_peak(DROP) < blocked_peak(load)
