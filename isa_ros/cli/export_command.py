"""The command `isa export`; its modules are imported in it, as in `commands`."""

import argparse

from isa_ros.cli import shared_arguments
from isa_ros.cli.commands import print_line, simulating


def arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments."""
    parser.add_argument(
        'actuator', metavar='MODEL|CONFIG[:ACTUATOR]',
        help='a model, or an actuator of a run file: isa_v5, leg.yaml:kfe')
    what = parser.add_mutually_exclusive_group(required=True)
    what.add_argument('--c', action='store_true', help='a shared library, header and examples')
    parser.add_argument(
        '--out', type=shared_arguments.directory_to_write, metavar='DIR', required=True,
        help='new directory, or that of an earlier export')
    parser.add_argument(
        '--load', choices=('own', 'port'),
        help='where its load is: its own, or that of the program at its port (default: port for '
        'a model; an actuator of CONFIG keeps the load that it has there)')
    parser.add_argument(
        '--name', metavar='NAME',
        help='begins the names of files and functions (default: isa_ and that of the actuator)')
    parser.add_argument(
        '--target', metavar='T',
        help='processor: x86-64-v3, x86-64 or aarch64 (default: the best that runs here)')
    parser.add_argument(
        '--compiler', default='cc', metavar='CC', help='of C, for T (default: %(default)s)')
    shared_arguments.gains(parser, 'NAME')
    shared_arguments.changes(
        parser, 'export with another value, by its key and in its unit: plant.drive.bore_mm=40')


@simulating
def export(options: argparse.Namespace) -> bool:
    """Write an actuator as a library of C."""
    from isa_ros.config.text.changes import values_of
    from isa_ros.core.objects import own_target
    from isa_ros.export.chosen import choose
    from isa_ros.export.directory import refuse_foreign, write
    from isa_ros.export.exported import exported
    from isa_ros.export.library import compiler_of, library, names_of, processor_of, target_of
    target = own_target() if options.target is None else target_of(options.target)
    compiler_of(options.compiler, processor_of(target))
    own = exported(choose(
        options.actuator, values_of(options.set, '--set'), preset=options.preset,
        variants=options.variant, load=options.load), name=options.name)
    refuse_foreign(options.out, names_of(own))
    print_line(f'machine code for {target.name} takes 10 to 20 s')
    write(options.out, library(own, target, options.compiler))
    for name in (f'{own.word}.h', f'lib{own.word}.so'):
        print(options.out / name)
    return True
