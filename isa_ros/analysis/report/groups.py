"""All groups of panels of a run: bodies first, then actuators, then circuits."""

from isa_ros.analysis.report.actuator_panels import actuator_group
from isa_ros.analysis.report.body_panels import body_group
from isa_ros.analysis.report.circuit_panels import circuit_group
from isa_ros.analysis.report.panels import Group
from isa_ros.analysis.signals.signals import Signals


def groups_of(signals: Signals) -> list[Group]:
    """Return the groups of a run that have something to draw."""
    run = signals.run
    found = [*(body_group(own, signals) for own in run.bodies),
             *(actuator_group(own, signals) for own in run.actuators),
             *(circuit_group(own, signals) for own in run.supplies)]
    return [group for group in found if group.panels]
