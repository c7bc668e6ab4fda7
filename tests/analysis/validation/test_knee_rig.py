"""The knee rig's checks: ground, edges and the fall evaluated from a run."""

import math

from isa_ros.analysis.experiment import Experiment, run
from isa_ros.analysis.signals.traces import Trace
from isa_ros.analysis.validation import knee_rig
import numpy as np
import pytest


def experiment(**topics: dict[str, np.ndarray]) -> Experiment:
    """Return an experiment of some topics over a second, one row a millisecond."""
    t = np.arange(1000) * 1e-3
    traces = {f'/{name.replace("__", "/")}': Trace(t, np.rec.fromarrays(
        list(fields.values()), names=list(fields))) for name, fields in topics.items()}
    return Experiment(None, traces)


def test_the_ground_alone_is_replaced():
    wood, rubber = (knee_rig.on_ground(material) for material in ('wood', 'rubber'))
    assert rubber.leg.sheet.ground.stiffness == 1e6 != wood.leg.sheet.ground.stiffness
    assert rubber.leg.sheet.body == wood.leg.sheet.body


def test_both_edges_of_a_force_step_are_measured_against_their_own_change():
    """200 to 500 N and back, 10 % over at the first and 20 % at the second."""
    force = np.full(1000, 200.0)
    force[300:700] = 500.0
    force[310:320] = 530.0
    force[710:720] = 140.0
    up, down = knee_rig.edges(experiment(kfe__joint_states={'effort[0]': force}), 'low')
    assert up.overshoot == pytest.approx(0.1) and down.overshoot == pytest.approx(0.2)
    assert up.steady_error == down.steady_error == 0.0


def test_errors_are_those_of_the_settled_periods():
    """A shift by 1 mm of a sine of 10 mm from 1.1 s on: the transient before has no influence."""
    t = np.arange(3000) * 1e-3
    wanted = 10e-3 * np.sin(2.0 * math.pi * t)
    measured = wanted + np.where(t < 1.1, 5e-3, 1e-3)
    traces = {
        '/kfe/joint_states': Trace(t, np.rec.fromarrays(
            [measured, np.full(3000, 3.0)], names=['position[0]', 'effort[0]'])),
        '/kfe/references': Trace(t, np.rec.fromarrays(
            [wanted, np.zeros(3000)], names=['position[0]', 'position[1]']))}
    position, force = knee_rig.tracking(Experiment(None, traces), 'kfe')
    assert position == pytest.approx(10.0) and force == pytest.approx(3.0)


def test_a_leg_that_never_lands_has_no_time_of_fall():
    in_the_air = {'wrench.force.z': np.zeros(1000)}
    assert math.isnan(knee_rig.touchdown(experiment(coordinator__ground_contact=in_the_air)))


def test_the_fall_takes_as_long_as_a_free_one():
    """
    10 cm at g take 143 ms.

    Until its release the leg sags by 3 mm under its impedance, 2 ms at 1.4 m/s, and contact
    is detected at ticks of 1 ms.
    """
    fall = knee_rig.touchdown(run('rig_knee', 'drop', duration=0.3))
    assert fall == pytest.approx(math.sqrt(2.0 * 0.1 / 9.80665), abs=3e-3)
