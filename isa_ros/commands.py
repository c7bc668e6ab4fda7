"""
What each command of `isa` does; a command returns whether its answer is yes.

Imports are late on purpose: `isa --help` has no time for numba, a wrong configuration none for
rclpy.
"""

from argparse import Namespace
from pathlib import Path

from isa_ros.errors import BagError
from isa_ros.paths import CONFIG, find, SCENARIOS

RUNS = Path('runs')  # where runs go that say nothing else


def demo(options: Namespace) -> bool:
    """Drop the leg, four processes, and draw the report of it."""
    from isa_ros.analysis.report import write_report
    from isa_ros.config import load_run
    from isa_ros.scenario import load_scenario
    run = load_run(find('leg.yaml', CONFIG))
    scenario = load_scenario(find('drop.yaml', SCENARIOS), run)
    out = options.out or free_directory('demo')
    from isa_ros.run import bringup as run_bringup
    run_bringup(scenario, out / 'bag')
    for path in write_report(out / 'bag', out / 'report.html'):
        print(path)
    return True


def bringup(options: Namespace) -> bool:
    """Run and record a configuration."""
    from isa_ros.config import load_run
    from isa_ros.scenario import idle, load_scenario
    run = load_run(find(options.config, CONFIG))
    scenario = (
        idle(run) if options.scenario is None
        else load_scenario(find(options.scenario, SCENARIOS), run))
    if options.duration is not None:
        scenario = scenario.lasting(options.duration)
    out = options.out or free_directory(scenario.run.name)
    from isa_ros.run import bringup as run_bringup
    run_bringup(
        scenario, out, overwrite=options.overwrite, real_time_factor=options.real_time_factor,
        in_process=options.in_process)
    print(out)
    return True


def free_directory(name: str) -> Path:
    """Return runs/NAME, or the first of runs/NAME_2, runs/NAME_3 ... that is free."""
    path, k = RUNS / name, 1
    while path.exists():
        k += 1
        path = RUNS / f'{name}_{k}'
    return path


def replay(options: Namespace) -> bool:
    """Simulate a bag again from itself, and compare."""
    from isa_ros.bag.reader import Bag
    from isa_ros.bag.replay import replay as replay_bag
    from isa_ros.bag.tolerances import load_tolerances
    bag = Bag(options.bag)
    tolerances = load_tolerances(options.tolerance, bag.types) if options.tolerance else None
    report = replay_bag(bag, tolerances)
    print(report)
    return report.is_equal


def compare(options: Namespace) -> bool:
    """Find the first difference of two bags."""
    from isa_ros.bag.compare import compare_bags
    from isa_ros.bag.reader import Bag
    from isa_ros.bag.tolerances import load_tolerances
    expected, actual = Bag(options.expected), Bag(options.actual)
    tolerances = load_tolerances(options.tolerance, expected.types) if options.tolerance else None
    report = compare_bags(expected, actual, tolerances)
    print(report)
    return report.is_equal


def report(options: Namespace) -> bool:
    """Draw the figures of a bag."""
    from isa_ros.analysis.report import write_report
    if not options.bag.exists():
        raise BagError(f'{options.bag}: no such bag')
    for path in write_report(options.bag, options.out or options.bag / 'report.html'):
        print(path)
    return True


def params(options: Namespace) -> bool:
    """List every parameter of a model, a leg or a run."""
    from isa_ros.params import describe
    print(describe(options.name, options.preset))
    return True


def bench(options: Namespace) -> bool:
    """Measure how fast this machine simulates."""
    from isa_ros.analysis.bench import bench as run_bench
    run_bench(options.json)
    return True
