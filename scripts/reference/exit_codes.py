"""The exit codes, from the errors and the ends of programs."""

from isa_ros import errors
from isa_ros.processes import ending
from scripts.reference.markup import escaped, page, table

_OWN = (
    (ending.DONE, 'done'),
    (ending.ANSWER_IS_NO, 'a check failed: bags differ, a value is not reached, a loop hunts, or '
     'with `--fail-on-trip` a condition of an actuator tripped'),
    (ending.WRONG_INPUT, 'a command, file or value that cannot be used'),
    (ending.NOT_COMPLETED, 'a run or a file that could not be completed'),
    (errors.SimulationDiverged.exit_code, 'a simulation that diverged'),
    (ending.DEFECT, 'a defect of isa_ros; please report the line'),
    (ending.INTERRUPTED, 'interrupted by Ctrl-C, SIGTERM or SIGHUP'))
_TAIL = """\
An error is one line on the error output; `--debug` or `{variable}=1` adds the traceback. Nodes
that end only by a signal exit with 0. A run in which a [condition](../protection.md) of an
actuator tripped ends with 0 as others do; with `--fail-on-trip`, of `isa bringup`, `isa bus` and
`isa view` (`fail_on_trip:=true` of a launch file), it ends with 1."""


def exit_codes_page() -> str:
    """Return the page."""
    kinds = [kind for kind in vars(errors).values()
             if isinstance(kind, type) and issubclass(kind, errors.IsaError)]
    rows = [[f'`isa_ros.errors.{kind.__name__}`', str(kind.exit_code),
             escaped((kind.__doc__ or '').partition('\n\n')[0])] for kind in kinds]
    return page(
        'Exit codes', table(['code', 'meaning'], [[str(code), text] for code, text in _OWN]),
        'From Python these are exceptions:', table(['exception', 'code', 'meaning'], rows),
        _TAIL.format(variable=ending.DEBUG_VARIABLE))
