"""The kernels of a run, compiled or loaded before anything waits for them."""

from contextlib import suppress

from isa_ros.actuator.actuator import Timing
from isa_ros.config.run_config import RunConfig
from isa_ros.errors import SimulationDiverged
from isa_ros.run.exchange import Rows
from isa_ros.run.stepping import SteppedActuator
from isa_ros.surroundings.surroundings import SharedLoad


def warmed_up(run: RunConfig) -> list[SteppedActuator]:
    """
    Return a copy of every actuator, after one tick of all and of a copy of their load.

    Where that diverges the run itself will say so, and record what was before.
    """
    timing, load = Timing(run.step_ns, run.controller_offset_ns), SharedLoad(run)
    rows = Rows(len(run.actuators))
    load.ports(rows.ports)
    copies = [SteppedActuator(config, timing) for config in run.actuators]
    with suppress(SimulationDiverged):
        for k, (copy, start) in enumerate(zip(copies, load.starts(run))):
            copy.start(start)
            copy.advance(rows.ports[k])
            rows.replies[k] = copy.actuator.reply_rows[0]
        load.advance(rows.replies)
    return copies
