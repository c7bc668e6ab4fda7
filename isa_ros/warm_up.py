"""The kernels of a run, compiled before anything waits for them."""

from isa_ros.actuator import Timing
from isa_ros.exchange import Rows
from isa_ros.run_config import RunConfig
from isa_ros.shared_load import SharedLoad
from isa_ros.stepping import SteppedActuator


def warmed_up(run: RunConfig, load: SharedLoad) -> list[SteppedActuator]:
    """Return a copy of every actuator, ticked once under the first port of ``load``."""
    timing = Timing(run.step_ns, run.controller_offset_ns)
    rows = Rows(len(run.actuators))
    load.ports(rows.ports)
    copies = [SteppedActuator(config, timing) for config in run.actuators]
    for copy, start, port in zip(copies, load.starts(run), rows.ports):
        copy.start(start)
        copy.advance(port)
    return copies
