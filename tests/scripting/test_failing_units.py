"""An inertial unit of a robot that fails: from a scenario, by hand, saved, recorded, replayed."""

from pathlib import Path
from typing import Any

import isa_ros
from isa_ros.bag.reader import Bag
from isa_ros.errors import ConfigError
from isa_ros.replay.replay import replay
import numpy as np
import pytest

FORCE, TURNING = 'body.trunk_specific_force', 'body.trunk_angular_velocity'
SOUND = {'rate_hz': 1000.0, 'can_fail': True, 'accelerometer_sigma': 0.0, 'gyro_sigma': 0.0}
START_S, END_S, TICKS = 0.02, 0.04, 60


def run(**unit: Any) -> isa_ros.Run:
    """Return a quadruped whose trunk has a unit without noise that can fail."""
    return isa_ros.load('quadruped.yaml', changes={
        f'body.imus.trunk.{key}': value for key, value in (SOUND | unit).items()})


def fault(**values: float) -> dict[str, Any]:
    return {'t_s': START_S, 'until_s': END_S, 'body': 'body',
            'set': {f'imus.trunk.{key}': value for key, value in values.items()}}


@pytest.fixture(scope='module')
def sound() -> isa_ros.Result:
    return run().simulate(TICKS * 1e-3)


def failing(**values: float) -> isa_ros.Result:
    return run().simulate(TICKS * 1e-3, faults=[fault(**values)])


def rows(result: isa_ros.Result) -> tuple[np.ndarray, np.ndarray]:
    """Return which rows have a reading with the fault, and which have none."""
    with_fault = (result.time > START_S + 1e-9) & (result.time < END_S + 1e-9)
    assert 19 <= with_fault.sum() <= 21
    return with_fault, ~with_fault


def test_nothing_else_changes_by_what_a_unit_reads(sound: isa_ros.Result) -> None:
    found = failing(lost=1.0)
    assert (found['body.position'] == sound['body.position']).all()
    assert (found['lf_kfe.force'] == sound['lf_kfe.force']).all()


def test_lost_it_reads_0_and_then_again_what_is_there(sound: isa_ros.Result) -> None:
    found = failing(lost=1.0, accelerometer_bias=0.5, gyro_sigma=0.1)
    broken, others = rows(found)
    for name in (FORCE, TURNING):
        assert (found[name][broken] == 0.0).all()
        assert (found[name][others] == sound[name][others]).all()
    assert (np.abs(sound[FORCE][broken][:, 2]) > 0.1).all()


def test_stuck_it_stays_as_it_was(sound: isa_ros.Result) -> None:
    found = failing(stuck=1.0)
    stuck, others = rows(found)
    before = sound[FORCE][np.flatnonzero(stuck)[0] - 1]
    assert (found[FORCE][stuck] == before).all() and (found[FORCE][others] == sound[FORCE][
        others]).all()
    assert len(np.unique(sound[FORCE][stuck], axis=0)) > 10


@pytest.mark.parametrize(('key', 'name', 'other', 'value'), [
    ('accelerometer_bias', FORCE, TURNING, -0.25), ('gyro_bias', TURNING, FORCE, 0.125)])
def test_an_offset_is_on_each_axis_of_its_sensor_alone(
        sound: isa_ros.Result, key: str, name: str, other: str, value: float) -> None:
    found = failing(**{key: value})
    shifted, others = rows(found)
    assert found[name][shifted] - sound[name][shifted] == pytest.approx(value, abs=1e-12)
    assert (found[name][others] == sound[name][others]).all()
    assert (found[other] == sound[other]).all()


def test_a_scale_is_that_of_both_before_the_offset(sound: isa_ros.Result) -> None:
    found = failing(scale=-0.5, accelerometer_bias=0.75)
    scaled, _ = rows(found)
    assert found[FORCE][scaled] == pytest.approx(-0.5 * sound[FORCE][scaled] + 0.75, abs=1e-12)
    assert found[TURNING][scaled] == pytest.approx(-0.5 * sound[TURNING][scaled], abs=1e-12)


@pytest.mark.parametrize(('key', 'name', 'sigma'), [
    ('accelerometer_sigma', FORCE, 2.0), ('gyro_sigma', TURNING, 0.5)])
def test_noise_has_its_deviation(
        sound: isa_ros.Result, key: str, name: str, sigma: float) -> None:
    """60 numbers: their deviation is known to 9 %; three of that."""
    found = failing(**{key: sigma})
    noisy, others = rows(found)
    errors = found[name][noisy] - sound[name][noisy]
    assert errors.std() == pytest.approx(sigma, rel=0.3)
    assert (found[name][others] == sound[name][others]).all()


def test_first_noise_and_bias_are_those_of_the_sheet() -> None:
    known = run(accelerometer_bias=0.3, gyro_bias=-0.2, accelerometer_sigma=0.04,
                gyro_sigma=0.01).simulation().surroundings.changing
    first = {name.removeprefix('body.imus.trunk.'): own.value for name, own in known.items()
             if name.startswith('body.imus.')}
    assert first == {
        'accelerometer_sigma': 0.04, 'accelerometer_bias': 0.3, 'gyro_sigma': 0.01,
        'gyro_bias': -0.2, 'scale': 1.0, 'stuck': 0.0, 'lost': 0.0}


def test_a_fault_is_recorded_and_replayed(tmp_path: Path) -> None:
    bag = Bag(failing(scale=0.5, gyro_sigma=0.01).save(tmp_path / 'bag'))
    assert replay(bag).is_equal


def test_a_push_and_a_fault_act_together(sound: isa_ros.Result) -> None:
    push = {'t_s': START_S, 'until_s': END_S, 'body': 'body', 'set': {'push_y': 3000.0}}
    pushed = run().simulate(TICKS * 1e-3, faults=[push])
    both = run().simulate(TICKS * 1e-3, faults=[push, fault(accelerometer_bias=1.0)])
    shifted, _ = rows(both)
    assert both['body.push_work'][-1] == pushed['body.push_work'][-1] > 1.0
    assert both[FORCE][shifted] - pushed[FORCE][shifted] == pytest.approx(1.0, abs=1e-12)


def test_a_saved_state_goes_on_in_the_middle_of_a_fault() -> None:
    own = run().simulation()
    for values in ({'imus.trunk.stuck': 1.0}, {'imus.trunk.scale': 0.5, 'imus.trunk.stuck': 0.0}):
        own.tune('body', values)
        for _ in range(5):
            own.step()
        again = run().simulation()
        again.restore(own.snapshot())
        for one in (own, again):
            for _ in range(5):
                one.step()
        assert (own.surroundings.bodies['body'].sample
                == again.surroundings.bodies['body'].sample).all()


def test_by_hand_it_is_lost_until_it_is_mended() -> None:
    own = run().simulation()
    sample = own.surroundings.bodies['body'].sample
    for lost, is_silent in ((1.0, True), (0.0, False)):
        own.tune('body', {'imus.trunk.lost': lost})
        own.step()
        assert (sample['trunk_specific_force'] == 0.0).all() == is_silent
        assert (sample['trunk_angular_velocity'] == 0.0).all() == is_silent


def test_a_shipped_unit_has_no_values_that_change() -> None:
    """A saved state has a number for each such value: those of before would be of another size."""
    run = isa_ros.load('quadruped.yaml')
    assert [name for name in run.simulation().surroundings.changing if 'imus' in name] == []
    assert 'can_fail' not in run.scenario.run.body('body').KEYS.tree(
        run.scenario.run.body('body'))['imus']['trunk']


@pytest.mark.parametrize(('values', 'message'), [
    ({'stuck': 0.5}, 'stuck = 0.5, must be 0 or 1'), ({'lost': 0.25}, 'lost = 0.25, must be 0 or'),
    ({'scale': 3.0}, 'imus.trunk.scale = 3, must be <= 2'),
    ({'drift': 1.0}, 'imus.trunk.drift of body is unknown or does not change')])
def test_a_fault_that_cannot_be_is_refused(values: dict[str, float], message: str) -> None:
    with pytest.raises(ConfigError, match=message):
        failing(**values)


def test_a_unit_that_cannot_fail_is_refused() -> None:
    with pytest.raises(ConfigError, match='imus.trunk.stuck of body is unknown or does not'):
        isa_ros.load('quadruped.yaml').simulate(0.05, faults=[fault(stuck=1.0)])
