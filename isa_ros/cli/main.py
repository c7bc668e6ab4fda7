"""
The command `isa`: arguments and exit codes; the commands are in `isa_ros.cli.commands`.

This module imports neither ROS nor numba, so that `isa --help` is fast.
"""

import argparse
from collections.abc import Sequence
import os
from pathlib import Path
import re
import signal
import sys
from types import FrameType
from typing import NoReturn

from isa_ros.cli import (
    bus_commands, commands, export_command, host_commands, measured_commands, response_arguments,
    run_arguments, shared_arguments, talk, view_command)
from isa_ros.cli.completion.scripts import SHELLS
from isa_ros.cli.shared_arguments import number
from isa_ros.core.suggest import alternatives
from isa_ros.core.version import VERSION
from isa_ros.processes.ending import (
    ANSWER_IS_NO, DEBUG_VARIABLE, DONE, end_of, replaced_handlers, WRONG_INPUT)


_CHOICE = re.compile(
    r"argument (?P<of>\S+): invalid choice: '(?P<given>[^']*)' \(choose from (?P<valid>.*)\)")
_NAME = re.compile(r"[^\s',]+")


class _Parser(argparse.ArgumentParser):
    """Parser with one-line errors."""

    _is_mixed = False
    _MIXES = True   # reads words that may be left out behind options

    def error(self, message: str) -> NoReturn:
        chosen = _CHOICE.match(message)
        if chosen is not None:      # of a dozen commands, name the nearest
            near = alternatives(chosen['given'], _NAME.findall(chosen['valid']))
            message = f'argument {chosen["of"]}: invalid choice: {chosen["given"]!r}; {near}'
        self.exit(WRONG_INPUT, f'{self.prog}: {message}; see {self.prog} --help\n')

    def parse_known_args(   # type: ignore[no-untyped-def]
            self, args=None, namespace=None):
        """
        Refuse what a command does not know by its own name: `isa` knows less of it.

        A word that may be left out is taken as left out once an option comes before it, so what
        is unknown at first is read once more, the options before the words.
        """
        found, unknown = super().parse_known_args(args, namespace)
        if unknown and ' ' in self.prog and not self._is_mixed:
            if self._MIXES and self._subparsers is None:
                self._is_mixed = True       # by which this method is called again
                try:
                    found, unknown = self.parse_known_intermixed_args(args, namespace)
                finally:
                    self._is_mixed = False
            if unknown:
                self.error(f'unrecognized arguments: {" ".join(unknown)}')
        return found, unknown


class _AsWritten(_Parser):
    """Parser of words with `--`: what stands behind it is no option, however often it is read."""

    _MIXES = False


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command and return its exit code."""
    words = sys.argv[1:] if arguments is None else arguments
    options = make_parser(words).parse_args(words)
    options.is_alone = arguments is None  # called as a program, not from Python
    # Every signal ends a command like Ctrl-C; a run replaces the handlers to stop after its tick.
    before = replaced_handlers(_interrupt)
    debug = os.environ.get(DEBUG_VARIABLE, '')
    if 'debug' in options:
        os.environ[DEBUG_VARIABLE] = '1'  # for the processes of a run too
    try:
        return DONE if options.command(options) else ANSWER_IS_NO
    except (Exception, KeyboardInterrupt) as error:
        return end_of('isa', error)
    finally:
        _restore(DEBUG_VARIABLE, debug)
        for own, handler in before.items():
            signal.signal(own, handler)


def _restore(variable: str, value: str) -> None:
    if value:
        os.environ[variable] = value
    else:
        os.environ.pop(variable, None)


def _interrupt(number: int, frame: FrameType | None) -> NoReturn:
    raise KeyboardInterrupt


def make_parser(words: Sequence[str] | None = None) -> argparse.ArgumentParser:
    """
    Return the parser of all commands.

    With the ``words`` of a command line, commands that are not among them are without their
    arguments: adding those of all takes 8 ms.
    """
    kind = _AsWritten if words is not None and '--' in words else _Parser
    common = kind(add_help=False)
    common.add_argument(
        '--debug', action='store_true', default=argparse.SUPPRESS,
        help='show the traceback of an error')
    parser = kind(
        prog='isa', parents=[common],
        description='Hydraulic integrated smart actuators, simulated in lockstep.')
    parser.add_argument(
        '--version', action='version', version=f'isa_ros {VERSION}',
        help='show the version of isa_ros and end')
    subparsers = parser.add_subparsers(metavar='COMMAND', required=True)
    for name, (add_arguments, command, summary) in _COMMANDS.items():
        below = subparsers.add_parser(name, parents=[common], help=summary, description=summary)
        if words is None or name in words:
            add_arguments(below)
        below.set_defaults(command=command)
    return parser


def _demo(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        '--out', type=Path, metavar='DIR', help='new directory (default: a new one in runs/)')


def _actuators(parser: argparse.ArgumentParser) -> None:
    parser.add_argument('config', metavar='CONFIG', help='a run file, or a shipped one by name')
    parser.add_argument(
        'names', nargs='*', metavar='NAME', help='an actuator of it (default: all)')
    parser.add_argument(
        '--scenario', metavar='FILE',
        help='scenario of the run, which may change loads or initial positions')
    parser.add_argument(
        '--namespace', default='', metavar='NAME', help='that of the run (default: the root)')
    shared_arguments.changes(parser, 'the values that are set for the run itself')


def _replay(parser: argparse.ArgumentParser) -> None:
    shared_arguments.bag(parser)
    _tolerance(parser)


def _recover(parser: argparse.ArgumentParser) -> None:
    shared_arguments.bag(parser)
    where = parser.add_mutually_exclusive_group()
    where.add_argument(
        '--out', type=Path, metavar='DIR',
        help='new directory for the complete bag (default: BAG_recovered; BAG stays as it is)')
    where.add_argument(
        '--in-place', action='store_true',
        help='replace the incomplete file and metadata.yaml of BAG itself')


def _compare(parser: argparse.ArgumentParser) -> None:
    shared_arguments.bag(parser, 'expected')
    shared_arguments.bag(parser, 'actual')
    _tolerance(parser)
    measured_commands.mapping(parser)
    shared_arguments.json_file(parser, 'every difference')
    parser.add_argument(
        '--report', type=Path, metavar='FILE.html', nargs='?', const=Path('compare.html'),
        help='also draw both over each other on a page (default: compare.html)')


def _tolerance(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        '--tolerance', type=Path, metavar='FILE', help='bounds by topic and field (default: none)')


def _report(parser: argparse.ArgumentParser) -> None:
    shared_arguments.bag(parser)
    parser.add_argument(
        '--out', type=Path, metavar='FILE.html', help='the page (default: beside the bag)')


def _identify(parser: argparse.ArgumentParser) -> None:
    shared_arguments.bag(parser)
    parser.add_argument('--actuator', metavar='NAME', help='only this one (default: all)')
    measured_commands.mapping(parser)
    parser.add_argument(
        '--config', metavar='CONFIG', help='of the actuator that a mapping is of')
    shared_arguments.json_file(parser)


def _draw(parser: argparse.ArgumentParser) -> None:
    parser.add_argument('config', metavar='CONFIG', help='a run file, or a shipped one by name')
    parser.add_argument(
        '--out', type=shared_arguments.like_before(
            'a figure', shared_arguments.PNG, b'<?xml', b'%PDF'), metavar='FILE', required=True,
        help='the figure: .png, .svg or .pdf')
    shared_arguments.changes(parser, 'draw with another value, by its key and in its unit')


def _params(parser: argparse.ArgumentParser) -> None:
    parser.add_argument('name', metavar='MODEL|CONFIG', help='isa_v5, hyq_real, leg.yaml, ...')
    shared_arguments.gains(parser, 'NAME')
    shared_arguments.changes(
        parser, 'list with another value, by its key and in its unit: plant.drive.bore_mm=40')


def _paper(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        'name', metavar='NAME', nargs='?', help='a table or a statement (default: all)')


def _validate(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        '--only', action='append', metavar='NAME', help='a group, or an entry as GROUP.ENTRY')
    parser.add_argument(
        '--sensitivity', action='store_true',
        help='which simulated entries notice wrong parameters; a few minutes')
    shared_arguments.json_file(parser, 'the entries')
    shared_arguments.page_directory(parser, 'validation.md and its figures, or sensitivity.md')
    parser.epilog = (
        'Exits with 1 if an entry of either source, paper or own, is not reached; with '
        '--sensitivity, if a perturbation is not noticed.')


def _study(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        'name', metavar='NAME', nargs='?', help='a study (default: list all studies)')
    parser.add_argument(
        '--all', action='store_true', help='run those of studies.md, about a minute')
    parser.add_argument('--model', metavar='M', help='only this actuator (default: all)')
    parser.add_argument(
        '--values', type=number, nargs='+', metavar='V',
        help='values instead of those of the study, in the unit of its table')
    shared_arguments.json_file(parser)
    shared_arguments.page_directory(
        parser, 'studies.md and its figures, or the page of a study with its own rig')


def _faults(parser: argparse.ArgumentParser) -> None:
    parser.add_argument('--list', action='store_true', help='only list the faults')
    parser.add_argument(
        '--situations', action='store_true',
        help='every fault at rest, slow, fast and blocked: what is noticed, and what it costs')
    parser.add_argument(
        '--only', action='append', metavar='NAME', help='a fault; may be repeated')
    shared_arguments.json_file(parser)
    shared_arguments.page_directory(parser, 'device_faults.md, or fault_situations.md')


def _doctor(parser: argparse.ArgumentParser) -> None:
    shared_arguments.json_file(parser, 'what was found')
    parser.epilog = 'Exits with 1 if something keeps runs from working.'


def _completion(parser: argparse.ArgumentParser) -> None:
    parser.add_argument('shell', metavar='SHELL', choices=SHELLS, help=', '.join(SHELLS))
    parser.epilog = (
        'bash, zsh: source <(isa completion bash); fish: isa completion fish | source')


def _bench(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        '--only', action='append', metavar='NAME', help='a group of rows; may be repeated')
    parser.add_argument(
        '--against', metavar='REV', help='also compare with a commit of this checkout: the same '
        'runs, old and new in turn')
    parser.add_argument(
        '--first-run', action='store_true', help='also make a wheel, install it aside, and '
        'measure its first run; some minutes')
    shared_arguments.json_file(parser)
    shared_arguments.page_directory(parser, 'bench.md and its figure')


_COMMANDS = {
    'demo': (_demo, commands.demo, 'drop the leg by 10 cm, record it, and draw a report'),
    'bringup': (run_arguments.bringup, commands.bringup, 'run and record a configuration'),
    'bus': (run_arguments.bus, bus_commands.bus,
            'serve the master of a real bus: EtherCAT, CANopen or a serial line'),
    'actuators': (_actuators, commands.actuators,
                  'run actuators of a configuration for a coordinator on another host'),
    'replay': (_replay, commands.replay, 'simulate the run of a bag again and compare'),
    'compare': (_compare, commands.compare,
                'compare the configurations and the messages of two bags'),
    'recover': (_recover, commands.recover,
                'complete a bag that was cut short, so that every reader opens it'),
    'report': (_report, commands.report, 'draw the figures of a bag on one page'),
    'view': (view_command.arguments, view_command.view,
             'show a run or play a bag in a browser, with its machine in 3D'),
    'bode': (response_arguments.bode, commands.bode,
             'measure the frequency response of a loop of an actuator'),
    'step': (response_arguments.step, commands.step,
             'measure the step response of a loop of an actuator'),
    'tune': (response_arguments.tune, commands.tune,
             'find gains of a loop for a wanted phase margin and bandwidth over the stroke'),
    'identify': (_identify, commands.identify, 'estimate valve, oil and friction from a bag'),
    'against': (measured_commands.against_arguments, measured_commands.against,
                'simulate with measured commands, compare, and find what closes the gap'),
    'study': (_study, commands.study,
              'vary one parameter and show the performance of the actuators'),
    'faults': (_faults, commands.faults,
               'inject every fault of the device into a rig and show its effect'),
    'params': (_params, commands.params, 'list every parameter with unit, range and source'),
    'export': (export_command.arguments, export_command.export,
               'write an actuator as a library of C or a unit of FMI, without Python'),
    'draw': (_draw, commands.draw, 'draw the linkages of a body and their levers over the stroke'),
    'paper': (_paper, commands.paper, 'show values and statements of the paper, with their place'),
    'validate': (_validate, commands.validate,
                 'compare the actuators with the numbers of the paper'),
    'echo': (talk.echo_arguments, talk.echo, 'print the messages of a topic'),
    'set': (talk.set_arguments, talk.set_values, 'set or show parameters of a running node'),
    'command': (talk.command_arguments, talk.command,
                'send a setpoint or a request to a running actuator'),
    'doctor': (_doctor, host_commands.doctor,
               'show what is installed, which middleware and which limits this host has'),
    'completion': (_completion, host_commands.completion,
                   'print the script that completes isa in a shell'),
    'bench': (_bench, commands.bench, 'measure the speed of simulations on this machine'),
}
