"""A session in this process without ROS: the same ticks and the same bag, no nodes."""

from collections.abc import Callable

from isa_ros.config.assembly import group_of, surroundings_of
from isa_ros.run.outlets import Outlets
from isa_ros.run.session import record, Report, Session
from isa_ros.run.warm_up import warmed_up
from isa_ros.tick.calling import calling
from isa_ros.tick.in_process import InProcess


def run_without_ros(
        session: Session, report: Report | None, should_stop: Callable[[], bool]) -> None:
    """Run and record; raises as `isa_ros.nodes.bringup.bringup`."""
    warmed_up(session.run)
    surroundings = surroundings_of(session.run)
    transport = calling(
        session.run, InProcess(group_of(session.run), surroundings.starts()))
    session.freeze_objects()
    record(session, transport, surroundings, lambda topics: Outlets(), report, should_stop)
