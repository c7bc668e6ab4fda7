"""Refuse the changes of a scenario that are each in range but not together."""

from collections.abc import Sequence

from isa_ros.actuator.tunable import changed_together, changing
from isa_ros.config.assembly import surroundings_in_form
from isa_ros.config.runs.run_config import RunConfig
from isa_ros.core.changing_values import bare, OFF
from isa_ros.core.timebase import NS_PER_SECOND
from isa_ros.errors import ConfigError
from isa_ros.scenario.faults import Fault, timetable


def refuse_changes(faults: Sequence[Fault], run: RunConfig) -> None:
    """
    Refuse values that are each in range but not together, at the time of each change.

    Waves and ramps are taken at one end of their values, and then at the other.

    Raises
    ------
    ConfigError
        Values do not fit together; the message has the time.

    """
    for end in (0, -1) if any(len(fault.extremes()) > 1 for fault in faults) else (0,):
        _refuse_steps([fault.extremes()[end] for fault in faults], run)


def _refuse_steps(faults: Sequence[Fault], run: RunConfig) -> None:
    if not faults:
        return
    surroundings = surroundings_in_form(run)
    in_force: dict[int, dict[str, float]] = {}
    for tick, changes in sorted(timetable(faults, run).items()):
        try:
            surroundings.tune(changes.supplies)
            for row, values in changes.actuators.items():
                now = in_force.setdefault(row, {})
                for name, value in values.items():
                    now.pop(bare(name), None)
                    if not name.startswith(OFF):
                        now[bare(name)] = value
                own = run.actuators[row]
                changed_together(own.sheet, own.load, now, changing(own.sheet, own.load))
        except ConfigError as error:
            raise ConfigError(
                f'at {tick * run.step_ns / NS_PER_SECOND:g} s, {error}') from error
