"""All groups of rows; see `isa_ros.bench` for how to add one."""

from collections.abc import Callable
from importlib import import_module
from pathlib import Path
import sys
from typing import NamedTuple

import isa_ros
from isa_ros.bench import against, first_run, leg, memory, over_kernels, startup
from isa_ros.bench.door import door_rows
from isa_ros.bench.in_memory import in_memory_rows
from isa_ros.bench.page import BenchDrawing
from isa_ros.bench.plant import cylinder_rows, plant_rows
from isa_ros.bench.robots import robot_rows
from isa_ros.bench.rounds import Outcomes
from isa_ros.bench.row import Row
from isa_ros.bench.spec import Spec
from isa_ros.bench.tick import tick_parts
from isa_ros.core.frozen import frozen

CHECKOUT = Path(isa_ros.__file__).parents[1]
BENCHMARKS = 'benchmarks'
"""Folder of a checkout with further groups; it is not installed."""
OF_BENCHMARKS = ('growth', 'peers', 'bus')
"""Names of its groups."""


@frozen
class BenchGroup:
    """A group of rows, and the runs it evaluates."""

    name: str
    title: str
    rows: Callable[[Outcomes], list[Row]]
    specs: Callable[[], tuple[Spec, ...]] = tuple
    drawing: Callable[[Outcomes], BenchDrawing | None] = lambda _: None
    missing: Callable[[], str] = str
    """Returns why the group cannot be measured here; '' if it can."""


def alone(rows: Callable[[], list[Row]]) -> Callable[[Outcomes], list[Row]]:
    """Return a group's function for rows measured in this process, without runs."""
    return lambda _: rows()


GROUPS = (
    BenchGroup('plant', 'One actuator, one core', alone(plant_rows)),
    BenchGroup('cylinder', 'A valve-driven cylinder with a known solution', alone(cylinder_rows)),
    BenchGroup('tick', 'Parts of a tick of the leg, without ROS', alone(tick_parts)),
    BenchGroup('kernels', 'A tick over its kernels alone', over_kernels.kernel_rows,
               lambda: over_kernels.SPECS),
    BenchGroup('in_memory', 'The leg in memory, without a bag', alone(in_memory_rows)),
    BenchGroup('door', 'A tick with an external body', alone(door_rows)),
    BenchGroup('robots', 'Quadrupeds that trot, without ROS', alone(robot_rows)),
    BenchGroup('leg', 'The leg, recording', leg.leg_rows, lambda: leg.SPECS),
    BenchGroup('trot', 'The quadruped that trots, in processes', leg.quadruped_rows,
               lambda: (leg.TROTTING,)),
    BenchGroup('startup', 'Start-up, caches warm', startup.startup_rows, lambda: startup.SPECS),
    BenchGroup('memory', 'Memory', memory.memory_rows, lambda: leg.SPECS),
)


class OnRequest(NamedTuple):
    """Groups that are measured on request only."""

    against: str | None = None
    """Revision to compare with."""
    first_run: bool = False
    """Whether to install a wheel."""

    @property
    def options(self) -> str:
        """Return the options of the command, each after a space."""
        against = f' --against {self.against}' if self.against else ''
        return against + (' --first-run' if self.first_run else '')


def groups(wanted: OnRequest = OnRequest()) -> tuple[BenchGroup, ...]:
    """Return all groups, those of this package first."""
    return GROUPS + _on_request(wanted) + _of_benchmarks()


def _on_request(wanted: OnRequest) -> tuple[BenchGroup, ...]:
    return (
        BenchGroup('against', f'This checkout against {wanted.against}, in turn',
                   alone(lambda: against.against_rows(wanted.against or '')),
                   missing=lambda: against.missing(wanted.against)),
        BenchGroup('first_run', 'The first run of an installed wheel',
                   alone(first_run.first_run_rows),
                   missing=lambda: first_run.missing(wanted.first_run)))


def _of_benchmarks() -> tuple[BenchGroup, ...]:
    if not (CHECKOUT / BENCHMARKS / 'peers').is_dir():
        return tuple(
            BenchGroup(name, '', alone(list), missing=_needs_a_checkout) for name in OF_BENCHMARKS)
    if str(CHECKOUT) not in sys.path:  # an editable installation puts its packages there only
        sys.path.append(str(CHECKOUT))
    added: tuple[BenchGroup, ...] = import_module(f'{BENCHMARKS}.groups').GROUPS
    return added


def _needs_a_checkout() -> str:
    return f'needs a checkout of isa_ros: its folder {BENCHMARKS} is not installed'
