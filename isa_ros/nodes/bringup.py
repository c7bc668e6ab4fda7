"""Bring-up of a run on ROS nodes, in several processes or in one; records a bag."""

from pathlib import Path

from isa_ros.nodes.coordinator.runs import in_one_process, in_processes
from isa_ros.processes.stopping import StopRequest
from isa_ros.run.options import Request
from isa_ros.run.session import prepare, Report, Session


def bringup(request: Request, report: Report | None = None) -> Path:
    """
    Run and record a configuration; return the directory of its bag.

    SIGINT, SIGTERM and SIGHUP end the run after its tick and close the bag.

    Raises
    ------
    ConfigError, BagError
        The request is invalid; nothing was started.
    RunError
        A participant or the recorder failed or did not answer in time; the bag is readable.
    SimulationDiverged
        A state is no longer finite; the bag is readable.
    Interrupted
        Stopped by a signal; the bag is readable.

    """
    return run_session(prepare(request), report)


def run_session(session: Session, report: Report | None = None) -> Path:
    """Run a prepared session; as `bringup`."""
    with StopRequest() as should_stop:
        in_one = session.request.in_process
        (in_one_process if in_one else in_processes)(session, report, should_stop)
    return session.out
