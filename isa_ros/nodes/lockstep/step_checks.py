"""What arrives from the coordinator: refuse a step that does not fit its run."""

from isa_ros.nodes.lockstep.roles import Role
from isa_ros.run.wire.steps import Step, StepKind


def refuse_misfit(step: Step, role: Role, n_participants: int) -> None:
    """Refuse a step that a participant of this run cannot execute; raises `WireError`."""
    if step.kind is StepKind.TICK:
        role.check(step)
    elif step.kind is StepKind.RESTORE:
        step.refuse_restore(n_participants)
    elif step.kind is StepKind.CHANGE:
        step.refuse_change(n_participants)
    elif step.kind is StepKind.BEGIN:
        step.refuse_begin(n_participants)
