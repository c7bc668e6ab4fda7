"""Actuators of a run on this host, for a coordinator on another."""

from collections.abc import Sequence
from pathlib import Path
import time

from isa_ros.config.runs.run_file import load_run
from isa_ros.config.text.changes import changes_of
from isa_ros.errors import RunError
from isa_ros.processes.domain_id import domain_id
from isa_ros.processes.processes import actuator_processes, Children
from isa_ros.processes.stopping import StopRequest
from isa_ros.run.warm_up import warmed_up
from isa_ros.scenario.scenario import planned

LOOK_PERIOD_S = 0.1


def host_actuators(
        config: Path, scenario: Path | None, names: Sequence[str],
        texts: Sequence[str] = (), namespace: str = '') -> None:
    """
    Start a process for each named actuator (default: for all) and keep them until a signal.

    They take part in one run after the other; a signal is their normal end. ``texts`` are the
    changes of a `Request`, ``namespace`` is its namespace.

    Raises
    ------
    ConfigError
        A file that cannot be run, an actuator that it does not declare, or a domain that DDS
        does not have.
    RunError
        One of the processes ended.

    """
    changes = changes_of(texts)
    run = planned(scenario, load_run(config, changes.run), changes).run
    chosen = [run.actuator(name).name for name in names] or None
    processes = actuator_processes(run, config, scenario, chosen, texts)
    domain_id()
    with StopRequest() as should_stop:
        warmed_up(run)
        with Children(processes, namespace) as children:
            while not should_stop():
                lost = children.lost()
                if lost is not None:
                    raise RunError(lost)
                time.sleep(LOOK_PERIOD_S)
