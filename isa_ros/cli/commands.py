"""
The commands of `isa`; each returns whether its check passed: bags equal, values reached.

Modules are imported in the functions, so that `isa --help` does not import numba.
"""

from argparse import Namespace
from collections.abc import Iterator
from itertools import count
from pathlib import Path
import sys
from typing import Any

from isa_ros.cli.running import PAGE, print_line, record, simulating
from isa_ros.config.paths import CONFIG, find, SCENARIOS
from isa_ros.errors import BagError, ConfigError, one_line
from isa_ros.run.option import namespace
from isa_ros.run.options import Request, request_of_arguments
from isa_ros.text.progress import underway

RUNS = Path('runs')  # default directory of demos


@simulating
def demo(options: Namespace) -> bool:
    """Drop the leg, in four processes, print what happened, and draw the report of the bag."""
    from isa_ros.analysis.report.energy import text_of
    from isa_ros.analysis.report.outcome import outcome
    from isa_ros.analysis.report.report import recorded as read_recorded, write_report
    from isa_ros.cli.next_steps import next_steps_text
    out = options.out or next(path for path in _demo_directories() if not path.exists())
    if out.exists():
        raise BagError(f'{out} already exists; a demo does not overwrite it')
    bag = record(Request(
        config=find('leg.yaml', CONFIG), scenario=find('drop.yaml', SCENARIOS),
        out=out / 'bag', is_alone=options.is_alone)).out
    found = read_recorded(bag)
    page, *figures = write_report(found, out / PAGE)
    print(f'{page}, and {len(figures)} figures beside it\n\n{outcome(found.signals)}\n')
    print(f'{text_of(found.accounts)}\n\n{next_steps_text(bag)}')
    return True


def _demo_directories() -> Iterator[Path]:
    yield RUNS / 'demo'
    for number in count(2):
        yield RUNS / f'demo_{number}'


@simulating
def bringup(options: Namespace) -> bool:
    """Run and record a configuration."""
    session = record(request_of_arguments(vars(options), is_alone=options.is_alone))
    return session.is_as_wanted


def actuators(options: Namespace) -> bool:
    """Run actuators of a configuration for a coordinator on another host."""
    from isa_ros.processes.actuator_host import host_actuators
    scenario = None if options.scenario is None else find(options.scenario, SCENARIOS)
    host_actuators(find(options.config, CONFIG), scenario, options.names, options.set,
                   namespace(options.namespace))
    return True


@simulating
def replay(options: Namespace) -> bool:
    """Simulate the run of a bag again and compare."""
    from isa_ros.bag.reader import Bag
    from isa_ros.replay.replay import replay as replay_bag
    from isa_ros.replay.tolerances import load_tolerances
    bag = Bag(options.bag)
    tolerances = load_tolerances(options.tolerance, bag.types) if options.tolerance else None
    report = replay_bag(
        bag, tolerances, lambda line: print(one_line(line), flush=True))
    print(report)
    return report.is_equal


def recover(options: Namespace) -> bool:
    """Complete a bag that was cut short."""
    from isa_ros.bag.recovery import recover as recover_bag
    print(recover_bag(options.bag, options.out, options.in_place))
    return True


def compare(options: Namespace) -> bool:
    """Compare the configurations and the messages of two bags, or with a mapping signals."""
    if options.mapping:
        if options.report:
            raise ConfigError(
                '--report is of two bags of isa_ros, and cannot be used with --mapping')
        from isa_ros.cli.measured_commands import compare as compare_measured
        return compare_measured(options)
    from isa_ros.bag.reader import Bag
    from isa_ros.replay.comparison import compared, names_of_runs
    from isa_ros.replay.tolerances import load_tolerances
    from isa_ros.text.json_file import write_tree
    expected, actual = Bag(options.expected), Bag(options.actual)
    tolerances = load_tolerances(options.tolerance, expected.types) if options.tolerance else None
    comparison = compared(expected, actual, tolerances)
    for line in comparison.lines(*names_of_runs(options.expected, options.actual)):
        print(one_line(line))
    if options.json:
        write_tree(comparison.tree(), options.json)
    if options.report:
        from isa_ros.analysis.report.beside import write_comparison
        from isa_ros.analysis.report.report import recorded as read_recorded
        runs = read_recorded(options.expected), read_recorded(options.actual)
        for path in write_comparison(comparison, runs, options.report):
            print(one_line(str(path)))
    return comparison.report.is_equal


def report(options: Namespace) -> bool:
    """Draw the report of a bag; print its verdict, what its devices did, where energy went."""
    from isa_ros.analysis.report.energy import text_of
    from isa_ros.analysis.report.events import events_text
    from isa_ros.analysis.report.report import another_version, recorded as read_recorded
    from isa_ros.analysis.report.report import write_report
    bag: Path = options.bag
    page = options.out or (bag if bag.is_dir() else bag.parent) / PAGE
    with underway(sys.stderr, one_line(f'reading {bag}, drawing its report')):
        found = read_recorded(bag)
        written = [*write_report(found, page)]
    for path in written:
        print(one_line(str(path)))
    if found.signals.problem:
        print_line(another_version(found.signals))
    print()
    for statement in found.verdict:
        print(one_line(statement.text))
    for table in (events_text(found.events), text_of(found.accounts)):
        if table:
            print(f'\n{table}')
    return True


@simulating
def bode(options: Namespace) -> bool:
    """Measure the frequency response of a loop."""
    from isa_ros.analysis.response.command import bode as measure_bode
    return measure_bode(options)


@simulating
def step(options: Namespace) -> bool:
    """Measure the step response of a loop."""
    from isa_ros.analysis.response.command import step as measure_step
    return measure_step(options)


def tune(options: Namespace) -> bool:
    """Find gains of a loop for a wanted margin and bandwidth."""
    from isa_ros.analysis.tuning.command import tune as find_gains
    return find_gains(options)


def identify(options: Namespace) -> bool:
    """Estimate the parameters of a bag's actuators, or with a mapping of a measured one."""
    if options.mapping:
        from isa_ros.cli.measured_commands import identify as identify_measured
        return identify_measured(options)
    from isa_ros.analysis.identification.identification import as_tree, identify_bag, table
    from isa_ros.text.json_file import write_tree
    found = identify_bag(options.bag, options.actuator)
    print(table(found))
    if options.json:
        write_tree(as_tree(found, options.bag), options.json)
    return True


@simulating
def study(options: Namespace) -> bool:
    """Vary one parameter against the performance."""
    from isa_ros.analysis.studies.command import study as run_study
    run_study(options)
    return True


@simulating
def faults(options: Namespace) -> bool:
    """List the faults of the device, or show the effect of each."""
    from isa_ros.analysis.faults.command import faults as show_faults
    return show_faults(options)


@simulating
def draw(options: Namespace) -> bool:
    """Draw the linkages of the bodies of a run file."""
    from isa_ros.analysis.linkages.command import draw as draw_linkages
    from isa_ros.config.listing import SET
    from isa_ros.config.text.changes import values_of
    print(draw_linkages(find(options.config, CONFIG), values_of(options.set, SET), options.out))
    print(options.out)
    return True


@simulating
def params(options: Namespace) -> bool:
    """List every parameter of a model, a leg or a run."""
    from isa_ros.config.text.changes import values_of
    from isa_ros.config.listing import describe, SET
    print(describe(
        options.name, options.preset, options.variant, values_of(options.set, SET)))
    return True


def paper(options: Namespace) -> bool:
    """Show values and statements of the paper."""
    from isa_ros.paper.show import describe
    print(describe(options.name))
    return True


@simulating
def validate(options: Namespace) -> bool:
    """Compare the actuators with the numbers of the paper."""
    if options.sensitivity:
        return _sensitivity(options)
    from isa_ros.validation import page
    from isa_ros.validation.groups import GROUPS
    from isa_ros.validation.runner import chosen, is_reached, validated
    from isa_ros.text.page import refuse_a_part
    from isa_ros.text.progress import counted
    groups = chosen(GROUPS, options.only)
    if options.out:
        refuse_a_part(options.out / page.PAGE, options.only)
    results = validated(groups, options.only, counted(sys.stderr, 'groups', stays=True))
    _show(page, results, options)
    return is_reached(results)


def _sensitivity(options: Namespace) -> bool:
    from isa_ros.validation import sensitivity_page
    from isa_ros.validation.sensitivity import is_noticed, sensitivity
    from isa_ros.text.progress import counted
    if options.only:
        raise ConfigError('--only is not used with --sensitivity, which runs every perturbation')
    found = sensitivity(progress=counted(sys.stderr, 'runs', stays=True))
    _show(sensitivity_page, found, options)
    return is_noticed(found)


def _show(page: Any, found: Any, options: Namespace) -> None:
    """Print a validation by its module of pages, and write its JSON and its page if wanted."""
    from isa_ros.text.json_file import write_tree
    from isa_ros.text.page import write_wanted_page
    print(page.as_text(found))
    if options.json:
        write_tree(page.as_tree(found), options.json)
    write_wanted_page(page, found, options.out)


@simulating
def bench(options: Namespace) -> bool:
    """Measure the speed of simulations on this machine."""
    from isa_ros.bench.command import bench as run_bench
    from isa_ros.bench.groups import OnRequest
    run_bench(options.json, options.only, options.out,
              OnRequest(options.against, options.first_run))
    return True
