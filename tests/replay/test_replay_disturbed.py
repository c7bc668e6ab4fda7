"""Noise, faults, lossy links and emergency stops in one run: it replays, and continues."""

from pathlib import Path

from isa_ros.bag.reader import Bag
from isa_ros.core.conditions import conditions
from isa_ros.core.device import ENABLED, FAULT, QUICK_STOP
from isa_ros.replay.replay import recorded_inputs, replay
from isa_ros.simulation import Simulation
import pytest
from tests.disturbed import disturbed_run, FAULTS, TICKS

RUN = disturbed_run()
HAA, HFE, KFE = range(3)


def test_the_run_has_noise_faults_and_losses() -> None:
    """Frames are old, a link trips its watchdog, a leak and an offset change what is measured."""
    result = RUN.simulate()
    age = result['haa.link.age']
    assert 0.045 < age.max() < 0.06 and len(set(age[20:90])) > 1   # lost for 50 ms, and before
    assert {name for value in set(result['haa.trips']) for name in conditions(value)} == {
        'link_lost'}
    stopped = [result[f'{name}.device_state'] for name in ('haa', 'hfe', 'kfe')]
    assert [list(states[[230, 299]]) for states in stopped] == [
        [QUICK_STOP, QUICK_STOP], [ENABLED, QUICK_STOP], [ENABLED, FAULT]]
    assert result['supply.dump_opening'][240] == 0.0 < result['supply.dump_opening'][-1]
    sound = RUN.replace({'scenario.faults': []}).simulate()
    quiet = RUN.replace({f'actuators.{name}.variants': [] for name in RUN.actuators}).simulate()
    assert (result['hfe.force'] - sound['hfe.force'])[82:].mean() > 100.0
    assert (result['kfe.force'][:50] != quiet['kfe.force'][:50]).any()


@pytest.mark.parametrize('saved_at', [60, 109, 130, 210, 245])
def test_it_goes_on_byte_for_byte_when_it_was_saved_in_its_faults(saved_at: int) -> None:
    """In the leak, the tick in which the watchdog trips, without a link, and in two stops."""
    first, twin = Simulation(RUN.scenario), Simulation(RUN.scenario)
    for _ in range(saved_at):
        first.step()
    twin.restore(first.snapshot())
    for _ in range(saved_at, TICKS):
        first.step(), twin.step()
        assert twin.group.samples.tobytes() == first.group.samples.tobytes()
        assert twin.group.observed.tobytes() == first.group.observed.tobytes()
        assert twin.surroundings.supplies.tobytes() == first.surroundings.supplies.tobytes()
    assert twin.snapshot() == first.snapshot()


def test_it_replays(tmp_path: Path) -> None:
    bag = Bag(RUN.simulate().save(tmp_path / 'bag'))
    inputs = recorded_inputs(bag, RUN.configuration)
    assert len(inputs.tuned) + len(inputs.tuned_supplies) >= len(FAULTS)
    report = replay(bag)
    assert report.is_equal, report
