"""The command `isa export`; its modules are imported in it, as in `commands`."""

import argparse
from collections.abc import Callable, Collection, Mapping
import sys
from typing import NamedTuple, TYPE_CHECKING

from isa_ros.cli import shared_arguments
from isa_ros.cli.running import print_line, simulating

if TYPE_CHECKING:
    from isa_ros.core.objects import Target
    from isa_ros.export.chosen import ChosenActuator
    from isa_ros.export.exported import Called


def arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments."""
    parser.add_argument(
        'actuator', metavar='MODEL|CONFIG[:ACTUATOR]',
        help='a model, or an actuator of a run file: isa_v5, leg.yaml:kfe')
    what = parser.add_mutually_exclusive_group(required=True)
    what.add_argument(
        '--c', action='store_true',
        help='a shared library, header and examples; not with --fmu')
    what.add_argument(
        '--fmu', action='store_true',
        help='with its supply, a unit of FMI 2.0 and one of FMI 3.0 for co-simulation; not with '
        '--c')
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
    """Write an actuator as a library of C, or with its supply as units of FMI."""
    from isa_ros.config.text.changes import values_of
    from isa_ros.core.objects import own_target
    from isa_ros.export.chosen import choose
    from isa_ros.export.directory import refuse_foreign, write
    from isa_ros.export.kernels import are_lowered
    from isa_ros.export.library import compiler_of, processor_of, target_of
    from isa_ros.text.progress import underway
    target = own_target() if options.target is None else target_of(options.target)
    compiler_of(options.compiler, processor_of(target))
    chosen = choose(
        options.actuator, values_of(options.set, '--set'), preset=options.preset,
        variants=options.variant, load=options.load)
    if chosen.assumptions:
        print_line(f'{chosen.config.model}: assumed {", ".join(chosen.assumptions)}; --set gives '
                   'the values of your data sheets')
    written = (_units if options.fmu else _library)(chosen, target, options)
    refuse_foreign(options.out, written.names)
    if not are_lowered(written.kernels, target):
        print_line(f'machine code for {target.name} takes 10 to 30 s, once after an installation '
                   'or an edit')
    with underway(sys.stderr, 'machine code'):
        files = written.files()
    write(options.out, files)
    for name in written.shown:
        print(options.out / name)
    return True


class _Written(NamedTuple):
    """Files of an export by name, those that are printed, and the kernels of each object."""

    names: Collection[str]
    shown: Collection[str]
    kernels: 'Collection[Collection[Called]]'
    files: Callable[[], Mapping[str, bytes]]


def _library(chosen: 'ChosenActuator', target: 'Target', options: argparse.Namespace) -> _Written:
    from isa_ros.export.exported import exported
    from isa_ros.export.library import library, names_of
    own = exported(chosen, name=options.name)
    return _Written(names_of(own), (f'{own.word}.h', f'lib{own.word}.so'), (own.kernels,),
                    lambda: library(own, target, options.compiler))


def _units(chosen: 'ChosenActuator', target: 'Target', options: argparse.Namespace) -> _Written:
    from isa_ros.export.fmi.unit import parts_of, units
    own = parts_of(chosen, options.name)
    names = own.files
    return _Written(names, names, own.kernels,
                    lambda: units(own, target, options.compiler))
