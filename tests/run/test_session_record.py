"""Recording a session with all actuators in this process."""

from pathlib import Path
from typing import Any

from isa_ros.bag.reader import Bag
from isa_ros.config.assembly import group_of, surroundings_of
from isa_ros.config.paths import CONFIG, find
from isa_ros.run.coordinator import Coordinator, Interrupted
from isa_ros.run.options import Request
from isa_ros.run.outlets import Outlets
from isa_ros.run.packing import Packer
from isa_ros.run.session import prepare, record, save_in_bag
from isa_ros.run.without_ros import run_without_ros
from isa_ros.tick.in_process import InProcess
import pytest


def test_the_packer_of_a_run_is_built_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """It encodes every message, which takes a millisecond for a leg."""
    make, built = Packer.__init__, []

    def count(self: Packer, *arguments: Any, **more: Any) -> None:
        built.append(self)
        make(self, *arguments, **more)

    monkeypatch.setattr(Packer, '__init__', count)
    session = prepare(Request(config=find('rig_linear', CONFIG), out=tmp_path / 'bag',
                              duration_s=0.005))
    surroundings = surroundings_of(session.run)
    transport = InProcess(group_of(session.run), surroundings.starts())
    record(session, transport, surroundings, lambda topics: Outlets(), None, lambda: False)
    assert len(built) == 1
    assert Bag(tmp_path / 'bag').end_ns == 5_000_000


TRIPS = {'t_s': 0.0, 'actuator': 'ram', 'set': {'plant.sensors.force.bias': 4000.0}}


@pytest.mark.parametrize(('fails', 'faults', 'as_wanted'), [
    (True, [TRIPS], False), (False, [TRIPS], True), (True, [], True)])
def test_a_session_keeps_what_tripped_and_may_fail_for_it(
        tmp_path: Path, fails: bool, faults: list[Any], as_wanted: bool):
    scenario = tmp_path / 'trips.yaml'
    scenario.write_text(f'name: trips\nduration_s: 0.07\nfaults: {faults}\n')
    session = prepare(Request(
        config=find('rig_linear', CONFIG), scenario=scenario, out=tmp_path / 'bag',
        fail_on_trip=fails))
    run_without_ros(session, None, lambda: False)
    assert session.is_as_wanted == as_wanted
    assert bool(session.tripped) == bool(faults)
    assert session.lines == session.tripped
    for line in session.lines:
        assert line.startswith('ram: load_cell_implausible tripped at t = 0.05')


def test_what_tripped_is_told_also_where_the_run_was_stopped(tmp_path: Path):
    scenario = tmp_path / 'trips.yaml'
    scenario.write_text(f'name: trips\nduration_s: 0.2\nfaults: {[TRIPS]}\n')
    session = prepare(Request(
        config=find('rig_linear', CONFIG), scenario=scenario, out=tmp_path / 'bag'))
    ticks = iter(range(100))
    with pytest.raises(Interrupted):
        run_without_ros(session, None, lambda: next(ticks) > 80)
    assert len(session.tripped) == 1


def test_a_state_saved_after_a_reset_lies_in_the_bag_of_that_run(tmp_path: Path):
    """In the second one: the first has another history; with a pace each tick is served."""
    session = prepare(Request(config=find('rig_linear', CONFIG), out=tmp_path / 'bag',
                              duration_s=0.005, real_time_factor=1.0))
    saved = []

    def serve(coordinator: Coordinator) -> None:
        if coordinator.ticks == 3 and len(session.bags) == 1:
            coordinator.reset()
        elif coordinator.ticks == 2 and len(session.bags) == 2:
            saved.append(save_in_bag(session, coordinator))
    surroundings = surroundings_of(session.run)
    transport = InProcess(group_of(session.run), surroundings.starts())
    record(session, transport, surroundings, lambda topics: Outlets(), None, lambda: False, serve)
    second = tmp_path / 'bag_2'
    assert saved == [str(second / 'state_2.json')] and Path(saved[0]).exists()
    assert (Bag(tmp_path / 'bag').end_ns, Bag(second).end_ns) == (3_000_000, 5_000_000)


@pytest.mark.parametrize(('option', 'given', 'expected'), [
    (False, None, False), (False, True, True), (True, None, True), (True, False, False)])
def test_a_reset_begins_as_its_request_says_or_else_as_the_options(
        tmp_path: Path, option: bool, given: bool | None, expected: bool):
    """Of the run after it alone: the one after a second reset is as the options say."""
    session = prepare(Request(config=find('rig_linear', CONFIG), out=tmp_path / 'bag',
                              duration_s=0.002, real_time_factor=1.0, is_paused=option))
    begun: list[Coordinator] = []
    paused: list[bool] = []

    def serve(coordinator: Coordinator) -> None:
        if coordinator in begun:
            return
        begun.append(coordinator)
        paused.append(coordinator.is_paused)
        if len(begun) < 3:
            coordinator.reset(given if len(begun) == 1 else None)
        else:
            coordinator.pause(False)
    surroundings = surroundings_of(session.run)
    transport = InProcess(group_of(session.run), surroundings.starts())
    record(session, transport, surroundings, lambda topics: Outlets(), None, lambda: False, serve)
    assert paused == [option, expected, option]
