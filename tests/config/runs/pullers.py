"""A controller for tests of sections with a class."""

from isa_ros.controller import Controller, Setpoint
from isa_ros.errors import ConfigError


class Puller(Controller):
    """Requests a force of one actuator where it is, without stiffness and damping."""

    def __init__(self, force: float, actuator: str) -> None:
        self._force, self._actuator = force, actuator

    @classmethod
    def of(cls, run, values, where):
        """Refuse a force below 0."""
        if values.get('force', 0.0) < 0.0:
            raise ConfigError(f'{where}: force = {values["force"]:g} N, must be >= 0 N')
        return super().of(run, values, where)

    def step(self, state):
        """Return the force."""
        return {self._actuator: Setpoint(
            state.actuators[self._actuator].position, effort=self._force, stiffness=0.0,
            damping=0.0)}

    def snapshot(self) -> bytes:
        """Return nothing."""
        return b''

    def restore(self, snapshot: bytes) -> None:
        """Do nothing."""


class Counting(Puller):
    """Pulls by as many newtons as it was called; begins at `start`."""

    def __init__(self, actuator: str, first: float = 0.0) -> None:
        super().__init__(first, actuator)
        self._first = first

    def start(self, names):
        """Begin anew."""
        self._force = self._first

    def step(self, state):
        """Return the force."""
        self._force += 1.0
        return super().step(state)

    def snapshot(self) -> bytes:
        """Return the number."""
        return str(self._force).encode()

    def restore(self, snapshot: bytes) -> None:
        """Go on from it."""
        self._force = float(snapshot.decode())


class Loose(Puller):
    """Takes what has no name, or any."""

    def __init__(self, actuator: str, *forces: float, gain: float = 1.0, **others: float) -> None:
        super().__init__(gain * sum(forces) + sum(others.values()), actuator)


def pull(run, values, where):
    """Return a controller, but not as a class."""
    return Puller(**values)


NO_CLASS = 3


class Failing(Controller):
    """Returns what it is given at its third tick, or raises it."""

    def __init__(self, found: object) -> None:
        self._found, self._calls = found, 0

    def start(self, names):
        """Count from zero."""
        self._calls = 0

    def step(self, state):
        """Return nothing at first."""
        self._calls += 1
        if self._calls < 3:
            return {}
        if isinstance(self._found, BaseException):
            raise self._found
        return self._found


class Absent(Failing):
    """Ends the program as it is made."""

    def __init__(self) -> None:
        raise SystemExit(0)


class Leaving(Failing):
    """Ends the program."""

    def __init__(self, code: int) -> None:
        super().__init__(SystemExit(code))
