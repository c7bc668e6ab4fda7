"""Commands on measurements that isa_ros did not record; modules are imported as in `commands`."""

import argparse
from argparse import Namespace
from pathlib import Path
import sys

from isa_ros.cli.running import simulating
from isa_ros.cli.shared_arguments import changes, figure_to_write, json_file, positive
from isa_ros.config.paths import CONFIG, find
from isa_ros.errors import ConfigError

RUNS_OF_A_LINE = 25     # of the search, where progress is written to a file


def against_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of `isa against`."""
    parser.add_argument('measured', type=Path, metavar='MEASURED', help='a CSV file or any bag')
    parser.add_argument('config', metavar='CONFIG', help='a run file, or a shipped one by name')
    mapping(parser, is_required=True)
    parser.add_argument(
        '--free', action='append', default=[], metavar='KEY[=LOW:HIGH]',
        help='a parameter of plant, reu or load that may change to close the gap, or clock_ppm, '
             'delay_ms; may be repeated (default: inertia, viscous friction, bulk modulus, '
             'delay_ms); none')
    parser.add_argument(
        '--duration', type=positive, metavar='S', help='only the first S seconds')
    changes(parser, 'another value of CONFIG, by its key and in its unit')
    json_file(parser)
    parser.add_argument('--out', type=figure_to_write, metavar='FILE.png', help='draw the figure')


def mapping(parser: argparse.ArgumentParser, is_required: bool = False) -> None:
    """Add the mapping of a measurement."""
    parser.add_argument(
        '--mapping', type=Path, metavar='FILE', required=is_required,
        action='store' if is_required else 'append',
        help='which column or topic is which quantity (docs/real_data.md)')


@simulating
def against(options: Namespace) -> bool:
    """Simulate a configuration with measured commands, and compare."""
    import isa_ros
    from isa_ros.analysis.figure_file import refuse_figure
    from isa_ros.analysis.measured.against import against as compared, as_text, as_tree
    from isa_ros.config.text.changes import values_of
    from isa_ros.text.json_file import write_wanted
    from isa_ros.text.progress import terminal_line
    refuse_figure(options.out)
    run = isa_ros.load(find(options.config, CONFIG), changes=values_of(options.set, '--set'))
    line = terminal_line(sys.stderr)

    def searching(n: int) -> None:
        if line:
            line.show(f'isa: run {n} of the search')
        elif n % RUNS_OF_A_LINE == 0:
            begun(f'run {n} of the search')

    def begun(text: str) -> None:
        print(f'isa: {text}', file=sys.stderr, flush=True)
    found = compared(
        options.measured, options.mapping, run, options.free, options.duration, searching, begun)
    if line:
        line.erase()
    print(as_text(found))
    write_wanted(as_tree(found, options.measured), options.json)
    if options.out:
        from isa_ros.analysis.measured.figure import overlay
        overlay(found).savefig(options.out)
        print(options.out)
    return True


def compare(options: Namespace) -> bool:
    """Compare the signals of two measurements, or of one and a bag."""
    from isa_ros.analysis.measured.beside import fits_of, fits_text, fits_tree
    from isa_ros.text.json_file import write_wanted
    for option in ('tolerance', 'report'):
        if getattr(options, option):
            raise ConfigError(f'--{option} is not used with --mapping')
    found = fits_of(options.expected, options.actual, options.mapping)
    print(fits_text(found))
    write_wanted(fits_tree(found), options.json)
    return True


def identify(options: Namespace) -> bool:
    """Estimate the parameters of a measured actuator."""
    import isa_ros
    from isa_ros.analysis.identification.identification import as_tree, table
    from isa_ros.analysis.measured.beside import identify_measured
    from isa_ros.text.json_file import write_wanted
    if options.config is None or len(options.mapping) != 1:
        raise ConfigError('a measurement needs one --mapping, and --config with its actuator')
    found = identify_measured(
        options.bag, options.mapping[0], isa_ros.load(find(options.config, CONFIG)))
    print(table(found))
    write_wanted(as_tree(found, options.bag), options.json)
    return True
