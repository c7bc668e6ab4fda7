"""The arguments of `isa bode`, `isa step` and `isa tune`."""

import argparse
from pathlib import Path

from isa_ros.cli import shared_arguments
from isa_ros.cli.shared_arguments import (
    count, figure_to_write, like_before, number, positive)

LOOPS = ('position', 'force', 'torque', 'pressure', 'spool', 'current')


def bode(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of `isa bode`."""
    _rig(parser, '*')
    parser.add_argument(
        '--bag', type=Path, metavar='BAG',
        help='evaluate a bag instead, of a scenario that sweeps the reference of the loop')
    parser.add_argument(
        '--of', choices=('closed', 'plant', 'open'), default='closed',
        help="output over reference, over the block's output, or over the error")
    parser.add_argument(
        '--method', choices=('stepped', 'chirp'), default='stepped',
        help='one sine after another (default), or a logarithmic chirp')
    parser.add_argument(
        '--from', dest='low', type=positive, metavar='HZ', help='lowest frequency')
    parser.add_argument(
        '--to', dest='high', type=positive, metavar='HZ', help='highest frequency')
    parser.add_argument(
        '--points', type=count, default=30, metavar='N', help='frequencies (default: 30)')


def step(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of `isa step`."""
    _rig(parser, '+')
    parser.add_argument(
        '--duration', type=positive, metavar='S', help='time recorded after the step')


def tune(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of `isa tune`."""
    parser.add_argument('name', metavar='MODEL|CONFIG', help='isa_v5, rig_rotary.yaml, ...')
    parser.add_argument(
        '--loop', choices=('force', 'torque'), default='force',
        help='the loop (default: force; of a rotary actuator torque is the same)')
    parser.add_argument(
        '--phase-margin', type=positive, default=60.0, metavar='DEG',
        help='of the open loop output/error (default: 60 deg)')
    parser.add_argument(
        '--bandwidth', type=positive, default=40.0, metavar='HZ',
        help='-3 dB of the closed loop (default: 40 Hz)')
    parser.add_argument(
        '--strokes', type=number, nargs='+', metavar='PERCENT',
        help='places of the stroke to measure at (default: 5 25 50 75 95)')
    _actuator(parser)
    parser.add_argument(
        '--load', metavar='KIND', help='load of the model (default: blocked)')
    parser.add_argument(
        '--amplitude', type=positive, metavar='A',
        help='of the reference, in N or Nm (default: 10 %% of the rated force)')
    shared_arguments.json_file(parser)
    parser.add_argument(
        '--out', type=like_before('of isa tune', b'# Tuned by isa tune.'), metavar='FILE.yaml',
        help='write a run file with the gains, for isa bringup')


def _actuator(parser: argparse.ArgumentParser) -> None:
    """Add what changes the measured actuator."""
    parser.add_argument('--actuator', metavar='NAME', help='actuator of a run file')
    shared_arguments.gains(parser, 'P')
    shared_arguments.changes(
        parser, 'another value of the actuator, or of the run file, by the key and in the unit '
        'that isa params shows: reu.force.kp=9e-8')


def _rig(parser: argparse.ArgumentParser, names: str) -> None:
    parser.add_argument(
        'names', nargs=names, metavar='MODEL|CONFIG',
        help='isa_v5, rig_rotary.yaml, ...; several are drawn in one figure')
    parser.add_argument(
        '--loop', choices=LOOPS, default='force',
        help='the loop to excite; the blocks outside it are off (default: force; of a rotary '
             'actuator torque is the same)')
    _actuator(parser)
    parser.add_argument(
        '--versus', action='append', default=[], metavar='KEY=VALUE[,KEY=VALUE...]',
        help='measure also with these values, in the same figure; may be repeated')
    parser.add_argument(
        '--load', metavar='KIND',
        help="load of the model (default: blocked; for the position loop the actuator's own)")
    parser.add_argument(
        '--position', type=number, metavar='X',
        help='initial position in mm or deg (default: as configured)')
    parser.add_argument(
        '--amplitude', type=positive, metavar='A',
        help='of the reference, in N, Nm, mm, deg, MPa or mA (default: 10 %% of the rated force, '
             '25 %% of spool travel and current, 1 %% of the stroke)')
    shared_arguments.json_file(parser)
    parser.add_argument('--out', type=figure_to_write, metavar='FILE.png', help='draw the figure')
