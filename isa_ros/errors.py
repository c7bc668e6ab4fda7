"""The errors that a user can cause or see, each with its exit code."""

LONGEST = 2000


def one_line(text: str) -> str:
    """Return a text, which may quote an untrusted file, as one line safe for a terminal."""
    shown = printable(text)
    return shown if len(shown) <= LONGEST else f'{shown[:LONGEST]} ...'


def printable(text: str) -> str:
    """Return a text with the codes of the characters that a terminal would act on."""
    if text.isprintable():
        return text
    return ''.join(c if c.isprintable() else repr(c)[1:-1] for c in text)


class IsaError(Exception):
    """Base of all errors of this package; the message is one line for the user."""

    exit_code = 2


class ConfigError(IsaError):
    """A configuration, scenario or command line that cannot be run."""


class ParameterError(ConfigError):
    """A parameter outside its declared range."""


class SetpointError(IsaError):
    """A setpoint that is rejected as a whole; the actuator keeps its last one."""


class BagError(IsaError):
    """A bag that cannot be read, or a directory in which none can be written."""


class AnalysisError(IsaError):
    """Signals from which the requested result cannot be computed."""


class RunError(IsaError):
    """A run that could not be completed: a participant or the recorder was lost or late."""

    exit_code = 3


class SimulationDiverged(IsaError):
    """A state that is no longer finite."""

    exit_code = 4

    def __init__(self, t_ns: int, field: str, value: float) -> None:
        super().__init__(
            f'{field} = {value} at t = {t_ns * 1e-9:.6f} s, must be finite: '
            'the simulation diverged')
        self.t_ns = t_ns
        self.field = field
        self.value = value

    def __reduce__(self) -> tuple[type['SimulationDiverged'], tuple[int, str, float]]:
        """Return what a copy in another process is made of."""
        return type(self), (self.t_ns, self.field, self.value)
