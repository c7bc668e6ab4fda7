"""
Regression tests from bags, for this package and its users.

In a conftest.py: ``pytest_plugins = ['isa_ros.testing']``; in a test::

    def test_my_leg_drops_as_recorded(assert_reproduces):
        assert_reproduces('my_leg.yaml', 'my_drop.yaml', 'bags/drop')

    def test_my_crane_swings_as_recorded(assert_reproduces):
        assert_reproduces('crane.yaml', 'swing.yaml', 'bags/swing', body='crane:crane')

    def test_the_simulator_still_gives_my_bag(assert_replays):
        assert_replays('bags/drop', 'bags/tolerances.yaml')

    def test_my_drop_trips_nothing(assert_no_trips):
        assert_no_trips(isa_ros.load('my_leg.yaml', 'my_drop.yaml').simulate())

`assert_no_trips` takes a result or a bag. `assert_reproduces` simulates the files and controllers
as they are today; it fails if one of them, or the simulator, gives other messages.
`assert_replays` simulates the configuration and the inputs that are stored in the bag; only
another simulator can fail it.

Without a tolerance file every bit must be equal. This holds on every x86-64 processor with the
same versions. Both functions may also be imported and called.
"""

from collections.abc import Callable
from functools import wraps
from pathlib import Path
import sys
from traceback import walk_tb
from typing import Any, cast, TypeVar

from isa_ros.bag.provenance import CONFIGURATION, VERSION
from isa_ros.bag.reader import Bag
from isa_ros.config.recorded_run import recorded_run
from isa_ros.config.text.yaml_text import Tree
from isa_ros.errors import BagError, ConfigError, SimulationDiverged
from isa_ros.replay.compare import Comparer, is_of_end, retyped
from isa_ros.replay.comparison import Comparison, key_lines
from isa_ros.replay.difference import RunDifference
from isa_ros.replay.provenance_differences import (
    provenance_differences, records_of, records_of_bag)
from isa_ros.replay.replay import replay
from isa_ros.replay.tolerances import load_tolerances, Tolerances
from isa_ros.run.events import trips_in
from isa_ros.run.provenance import provenance_of
from isa_ros.run.recorded import history_of
from isa_ros.scripting.bag import ResultMessages
from isa_ros.scripting.result import Result, simulated
from isa_ros.scripting.run import Controllers, Factories, load
from isa_ros.tick.trips import Tripped
from msg_adapters import event
import pytest

__all__ = ['assert_no_trips', 'AssertNoTrips', 'assert_replays', 'AssertReplays',
           'assert_reproduces', 'AssertReproduces']

_Check = TypeVar('_Check', bound=Callable[..., None])
AssertNoTrips = Callable[..., None]
AssertReplays = Callable[..., None]
AssertReproduces = Callable[..., None]

_INNER = {'isa_ros', 'msg_adapters', 'numpy', 'yaml', *sys.stdlib_module_names}
"""Packages whose frames say nothing to a user."""
_NAMES = ('in the bag', 'now')  # of both runs in a message


def _without_inner_frames(check: _Check) -> _Check:
    """Return a check whose error of a bag or file shows no frames, unless some are a user's."""
    @wraps(check)
    def shown(*arguments: Any, **named: Any) -> None:
        __tracebackhide__ = True
        try:
            check(*arguments, **named)
        except (BagError, ConfigError) as error:
            if all(frame.f_globals.get('__name__', '').partition('.')[0] in _INNER
                   for each in (error, error.__cause__) if each
                   for frame, _ in walk_tb(each.__traceback__)):
                raise error.with_traceback(None) from None
            raise
    return cast(_Check, shown)


@_without_inner_frames
def assert_no_trips(run: Result | Path | str) -> None:
    """
    Assert that no condition of an actuator tripped in a run: its result, or its bag.

    Raises
    ------
    AssertionError
        Has a line for each condition that tripped.
    BagError
        The bag cannot be read, or was cut short.

    """
    __tracebackhide__ = True
    tripped = Tripped()
    if isinstance(run, Result):
        tripped.add(run.trips)
        name = repr(run)
    else:
        bag = _whole(run)
        own = recorded_run(bag.provenance.configuration, f'{run}: {CONFIGURATION}').run
        tripped.add(trips_in(own, history_of(bag, own)))
        name = str(run)
    if tripped:
        raise AssertionError('\n'.join([f'{name}: a condition tripped', *tripped.lines()]))


@_without_inner_frames
def assert_replays(bag: Path | str, tolerances: Path | str | None = None) -> None:
    """
    Simulate a bag again, with its own configuration and inputs, and compare every message.

    Raises
    ------
    AssertionError
        The replay differs; the message has the first tick, topic and field with both values, and
        the differences between this installation and the one that recorded the bag.
    BagError, ConfigError
        The bag or the tolerance file cannot be read, or the bag was cut short or cannot be
        simulated.

    """
    __tracebackhide__ = True
    recorded = _whole(bag)
    report = replay(recorded, _tolerances(recorded, tolerances))
    if not report.is_equal:
        lines = [f'{bag}: {report}', *report.changes]
        if tolerances is None:
            lines.append(_why_bits_differ(
                'Versions or topics differ as listed' if report.changes else
                'Versions and topics are those of the bag'))
        raise AssertionError('\n'.join(lines))


@_without_inner_frames
def assert_reproduces(
        config: str | Path | Tree, scenario: str | Path | Tree | None, bag: Path | str,
        tolerances: Path | str | None = None, controllers: Controllers = (), *,
        duration: float | None = None, body: Factories | None = None) -> None:
    """
    Simulate files, controllers and bodies as they are today; compare every message with a bag.

    ``config``, ``scenario`` and ``duration`` (s) are those of `isa_ros.load`, ``controllers`` and
    ``body`` those of `Run.simulate`. Without a scenario the run lasts as long as the bag. Recorded
    events, such as pauses, are not compared.

    Raises
    ------
    AssertionError
        The run differs; the message has first what external bodies say of themselves (a digest
        of the model), and the keys of configuration, scenario and versions, where they differ,
        with both values and unit, then the first difference, then the largest deviation of each
        topic with field, tick, values and tolerance.
    BagError, ConfigError
        A file cannot be read or run, or the bag was cut short or does not begin at t = 0.
    RunError
        The caller's body fails.

    """
    __tracebackhide__ = True
    recorded = _whole(bag)
    allowed = _tolerances(recorded, tolerances)
    if recorded.end_ns is None or recorded.provenance.state is not None:
        lacks = 'has no samples' if recorded.end_ns is None else 'continues a saved state'
        raise BagError(f'{bag}: {lacks}, must be a run from t = 0')
    simulation = load(config, scenario, duration=duration).simulation(
        controllers, body=body)
    plan = simulation.scenario
    n_ticks = plan.n_ticks
    if n_ticks is None:
        n_ticks = (recorded.end_ns - (recorded.start_ns or 0)) // plan.run.step_ns
    keys = provenance_differences(
        records_of_bag(recorded), records_of(
            provenance_of(plan, None, simulation.surroundings.provenance), plan.run.source))
    head = f'{bag}: not reproduced by {plan.run.source}, scenario {plan.name}'
    try:
        result = simulated(simulation, n_ticks)
    except SimulationDiverged as error:
        raise AssertionError('\n'.join([head, *key_lines(keys, *_NAMES), str(error)])) from error
    report = _compared(recorded, result, allowed)
    if not report.is_equal:
        lines = [head, *Comparison(keys, report).lines(*_NAMES)]
        if tolerances is None and all(key.key.startswith(VERSION) for key in keys or ()):
            lines.append(_why_bits_differ(
                'Controllers and external bodies are not stored in a bag'))
        raise AssertionError('\n'.join(lines))


@pytest.fixture(name='assert_no_trips')
def _assert_no_trips() -> AssertNoTrips:
    """Return `assert_no_trips`."""
    return assert_no_trips


@pytest.fixture(name='assert_replays')
def _assert_replays() -> AssertReplays:
    """Return `assert_replays`."""
    return assert_replays


@pytest.fixture(name='assert_reproduces')
def _assert_reproduces() -> AssertReproduces:
    """Return `assert_reproduces`."""
    return assert_reproduces


def _whole(bag: Path | str) -> Bag:
    """
    Return a bag: the part of one that is there would pass a test that the rest does not.

    Raises
    ------
    BagError
        It cannot be read, or was cut short.

    """
    found = Bag(Path(bag))
    if not found.is_whole:
        raise BagError(f'{bag}: is cut short, by a recorder that was killed or a copy that was '
                       'not finished; isa recover completes what is there')
    return found


def _tolerances(bag: Bag, tolerances: Path | str | None) -> Tolerances | None:
    return None if tolerances is None else load_tolerances(Path(tolerances), bag.types)


def _compared(bag: Bag, result: Result, tolerances: Tolerances | None) -> RunDifference:
    """Return the comparison of a result with a bag; without events, which files do not give."""
    messages = ResultMessages(result.scenario, result.log)
    other = retyped(bag, {topic.name: topic.type_name for topic in messages.topics})
    run = result.scenario.run
    end_ns = run.start_ns + (len(result.log.samples) - 1) * run.step_ns
    without = {event.TOPIC[0], *(difference.topic for difference in other)}
    comparer = Comparer(
        bag, [topic.name for topic in messages.topics], tolerances,
        lambda topic, sequence, t_ns: topic not in without
        and not is_of_end(topic, t_ns, bag.end_ns, end_ns), is_exact=True, is_to_end=True)
    for difference in other:
        comparer.note(difference)
    messages.record(comparer)
    return comparer.finish()


def _why_bits_differ(remark: str) -> str:
    """Return possible reasons of unequal bits."""
    return (
        'No tolerances were given, so every bit must be equal, which holds with the same '
        f'versions on any x86-64 processor. {remark}. For other versions give tolerances.')
