"""Launch files, and the nodes that they start."""

from pathlib import Path

from tests.launch.stand_ins import Context, ProcessExited

LAUNCH = Path(__file__).parents[2] / 'launch'


def ended(nodes) -> None:
    """Release the name that a launch holds, as the end of its coordinator does."""
    nodes[-1].given['on_exit'](ProcessExited('coordinator-1', 0), Context())


def parameters(node, *names: str) -> dict[str, object]:
    """Return all or some parameters of a node, each of the type that is said to be its own."""
    values, given = {}, node.given['parameters'][0]
    for key in names or given:
        value = given[key]
        declared = value.given['value_type']
        assert declared is type(value.args[0]) or declared == list[str]
        values[key] = value.args[0]
    return values
