"""What became of a commanded setpoint, among all that arrives at the same time."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any

from builtin_interfaces.msg import Time
from isa_ros.core.device import IMPEDANCE
from isa_ros.core.signals import HAS_MODE, HAS_SETPOINT
from isa_ros.errors import ConfigError, RunError
from isa_ros.nodes.terminal import setpoints
from isa_ros.nodes.terminal.setpoints import command, GivenSetpoint
import pytest
from rcl_interfaces.msg import Log
from sensor_msgs.msg import JointState
from std_msgs.msg import Header

WANTED = GivenSetpoint(0.03, None, None, {}, {})


def applied(position: float, changed: int, sec: int) -> JointState:
    """Return an applied setpoint of the ram, a quarter of a second after a full one."""
    entries = {'ram': position, 'ram/stiffness': 2e5, 'ram/damping': 4e3,
               'ram/mode': float(IMPEDANCE), 'ram/changed': float(changed)}
    return JointState(
        header=Header(stamp=Time(sec=sec, nanosec=250_000_000)), name=list(entries),
        position=list(entries.values()), velocity=[0.5], effort=[7.0])


def rejected(by: str) -> Log:
    return Log(name=by, msg=f'setpoint rejected: by {by}')


KEPT = applied(0.011, HAS_SETPOINT, 1)


class Visiting:
    """A visitor and its node; one kept setpoint is there, and each wait ends at once."""

    seconds = '3 s'

    def __init__(self, answers: Sequence[Any]) -> None:
        self.node, self._answers = self, answers
        self.callbacks: dict[type, Callable[[Any], None]] = {}
        self.sent: list[JointState] = []

    def create_subscription(
            self, kind: type, topic: str, callback: Callable[[Any], None], _: object) -> None:
        self.callbacks[kind] = callback
        if kind is JointState:
            callback(KEPT)

    def create_publisher(self, *given: object) -> 'Visiting':
        return self

    def get_subscription_count(self) -> int:
        return 1

    def publish(self, message: JointState) -> None:
        self.sent.append(message)
        for answer in self._answers:
            self.callbacks[type(answer)](answer)

    def wait(self, condition: Callable[[], Any], *timeout: float) -> bool:
        return bool(condition())


def commanded(
        monkeypatch: pytest.MonkeyPatch, *answers: Any, is_followed: bool = True) -> list[str]:
    """Return what a command prints that is answered so."""
    visitor = Visiting(answers)

    @contextmanager
    def visiting(timeout_s: float) -> Iterator[Visiting]:
        yield visitor
    monkeypatch.setattr(setpoints, 'visiting', visiting)
    lines: list[str] = []
    assert command('lab/ram', WANTED, 3.0, lines.append) is is_followed
    assert [(list(own.name), list(own.position)) for own in visitor.sent] == [(['ram'], [0.03])]
    return lines


def test_the_first_setpoint_after_it_is_shown_with_its_time(monkeypatch):
    """Neither the kept one nor a change of the mode that comes before."""
    lines = commanded(monkeypatch, applied(0.02, HAS_MODE, 2), applied(0.03, HAS_SETPOINT, 3),
                      applied(0.04, HAS_SETPOINT, 4))
    assert lines == ['/lab/ram: impedance: position 0.03, velocity 0.5, effort 7, '
                     'stiffness 200000, damping 4000, from t = 3.250000 s on']


@pytest.mark.parametrize('is_enabled', [True, False])
def test_a_device_that_is_not_enabled_does_not_follow(monkeypatch, is_enabled):
    """It was not at the kept setpoint, or is not at the new one."""
    kept, taken = applied(0.011, HAS_SETPOINT, 2), applied(0.03, HAS_SETPOINT, 3)
    for message, number in ((kept, not is_enabled), (taken, is_enabled)):
        message.name = [*message.name, 'ram/enabled']
        message.position = [*message.position, float(number)]
    monkeypatch.setattr(f'{__name__}.KEPT', kept)
    line, = commanded(monkeypatch, taken, is_followed=is_enabled)
    end = ' s on' if is_enabled else ' s on, not followed: the device is not enabled'
    assert line.endswith(f'from t = 3.250000{end}')


def test_a_rejection_counts_for_its_own_actuator(monkeypatch):
    taken = applied(0.03, HAS_SETPOINT, 3)
    assert len(commanded(monkeypatch, rejected('lab.rom'), taken)) == 1
    with pytest.raises(ConfigError, match='^/lab/ram: setpoint rejected: by lab.ram$'):
        commanded(monkeypatch, rejected('lab.rom'), rejected('lab.ram'), taken)


def test_another_line_of_the_log_is_no_rejection(monkeypatch):
    assert len(commanded(monkeypatch, Log(name='lab.ram', msg='ready'),
                         applied(0.03, HAS_SETPOINT, 3))) == 1


def test_a_setpoint_that_is_not_applied_is_an_error(monkeypatch):
    with pytest.raises(RunError, match='actuator /lab/ram: applied no setpoint within 3 s'):
        commanded(monkeypatch, applied(0.02, HAS_MODE, 2))
