"""All groups of rows; see `isa_ros.bench` for how to add one."""

from collections.abc import Callable
from dataclasses import dataclass

from isa_ros.bench import comparison, growth, leg, memory, startup
from isa_ros.bench.bus import bus_rows
from isa_ros.bench.in_memory import in_memory_rows
from isa_ros.bench.plant import cylinder_rows, plant_rows
from isa_ros.bench.rounds import Outcomes
from isa_ros.bench.row import Row
from isa_ros.bench.spec import Spec
from isa_ros.bench.tick import tick_parts


@dataclass(frozen=True)
class Group:
    """A group of rows, and the runs it evaluates."""

    name: str
    title: str
    rows: Callable[[Outcomes], list[Row]]
    specs: Callable[[], tuple[Spec, ...]] = tuple


def _alone(rows: Callable[[], list[Row]]) -> Callable[[Outcomes], list[Row]]:
    """Return a group's function for rows measured in this process, without runs."""
    return lambda _: rows()


GROUPS = (
    Group('plant', 'One actuator, one core', _alone(plant_rows)),
    Group('cylinder', 'A valve-driven cylinder with a known solution', _alone(cylinder_rows)),
    Group('tick', 'Parts of a tick of the leg, without ROS', _alone(tick_parts)),
    Group('in_memory', 'The leg in memory, without a bag', _alone(in_memory_rows)),
    Group('leg', 'The leg, recording', leg.leg_rows, lambda: leg.SPECS),
    Group('peers', 'The same exchange over other middlewares', comparison.comparison_rows,
          lambda: comparison.SPECS),
    Group('growth', 'From 1 to 24 actuators, recording', growth.growth_rows, growth.specs),
    Group('bus', 'The actuators on EtherCAT, recording', _alone(bus_rows)),
    Group('startup', 'Start-up, caches warm', startup.startup_rows, lambda: startup.SPECS),
    Group('memory', 'Memory', memory.memory_rows, memory.specs),
)
