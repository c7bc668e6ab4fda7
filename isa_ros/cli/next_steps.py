"""What `isa demo` ends with: commands to try next, each as it can be typed."""

from collections.abc import Sequence
from pathlib import Path
import shlex
import shutil

from isa_ros.text.table import aligned

OWN_RUN = 'runs/mine'


def next_steps(bag: Path) -> list[tuple[str, str]]:
    """Return the arguments of `isa` and what they do, in the order to try them."""
    return [
        (f'replay {shlex.quote(str(bag))}', 'simulate the bag again: the same bytes'),
        (f'view {shlex.quote(str(bag))}', 'see the leg move in a browser'),
        ('params isa_v5', 'every parameter with unit, range and source'),
        (f'bringup leg --scenario drop --set supply.pressure_mpa=10 --out {OWN_RUN}',
         'the same drop with half the pressure'),
        (f'compare {shlex.quote(str(bag))} {OWN_RUN}', 'what differs between both runs'),
        ('bringup leg --real-time-factor 1', 'a leg to command, until Ctrl-C; in a second '
         'terminal:'),
        ('command kfe 0.03', 'move its knee'),
        ('echo kfe/joint_states --count 1', 'where it is'),
        ('step isa_v5 --loop force', 'step response of the force loop'),
        ('doctor', 'what this host has')]


def next_steps_text(bag: Path) -> str:
    """Return the steps as lines for a terminal."""
    name = command_name()
    rows: Sequence[tuple[str, str]] = [
        (f'  {name} {arguments}', meaning) for arguments, meaning in next_steps(bag)]
    return '\n'.join(['what to try next:', *aligned(rows)])


def command_name() -> str:
    """Return how to call `isa` from here: by the PATH, else as the script of a clone."""
    return './isa' if shutil.which('isa') is None and Path('isa').is_file() else 'isa'
