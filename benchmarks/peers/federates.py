"""
HELICS: coordinator and workers are federates that request time from a broker.

The coordinator is granted times k, the workers times k + 1/2: workers receive a step published at
k at k + 1/2, and the coordinator receives their answers at k + 1. That is one grant of time per
federate and tick, the minimum. The coordinator requests time before it records, so that recording
overlaps with the workers as in a run.
"""

from collections import deque
from pathlib import Path
import socket
import time

import helics
from isa_ros.errors import RunError

CORE = 'tcp_ss'         # the fastest reliable core; zmq, the default, is slower
PERIOD = 1.0            # HELICS time of a tick, s
JOIN_S = 30.0
_POLL_S = 0.01
_PORT = 'port'         # file with the broker's port, in the directory of a run
_HOST = '127.0.0.1'
_STEPS = 'steps'


class CoordinatorFederate:
    """The federate of the coordinator, and the broker."""

    def __init__(self, directory: Path, n_workers: int) -> None:
        name = directory.name
        port = _free_port()
        (directory / _PORT).write_text(str(port))
        self._broker = helics.helicsCreateBroker(
            CORE, name, f'--federates={n_workers + 1} --port={port} --loglevel=no_print')
        self._federate = _federate(f'{name}_coordinator', port, offset=0.0)
        self._steps = helics.helicsFederateRegisterGlobalPublication(
            self._federate, _STEPS, helics.HELICS_DATA_TYPE_RAW)
        self._answers = [
            helics.helicsFederateRegisterSubscription(self._federate, _answers(k))
            for k in range(n_workers)]
        self._arrived: deque[bytes] = deque()
        self._is_executing = False
        self._is_asked = False
        self._now = 0.0

    def send(self, message: bytes) -> None:
        """Publish and request the next period; wait for the workers the first time."""
        if not self._is_executing:
            self._enter()
        self._take_granted()
        helics.helicsPublicationPublishBytes(self._steps, message)
        helics.helicsFederateRequestTimeAsync(self._federate, self._now + PERIOD)
        self._is_asked = True

    def receive(self, timeout_s: float) -> bytes | None:
        """Wait for the period, without timeout, and return one of its answers."""
        if not self._arrived:
            self._take_granted()
        return self._arrived.popleft() if self._arrived else None

    def _enter(self) -> None:
        helics.helicsFederateEnterExecutingModeAsync(self._federate)
        deadline = time.monotonic() + JOIN_S
        while not helics.helicsFederateIsAsyncOperationCompleted(self._federate):
            if time.monotonic() > deadline:
                raise RunError(f'helics: no federation after {JOIN_S:g} s')
            time.sleep(_POLL_S)
        helics.helicsFederateEnterExecutingModeComplete(self._federate)
        self._is_executing = True

    def _take_granted(self) -> None:
        if not self._is_asked:
            return
        self._is_asked = False
        self._now = helics.helicsFederateRequestTimeComplete(self._federate)
        self._arrived.extend(
            helics.helicsInputGetBytes(answer) for answer in self._answers
            if helics.helicsInputIsUpdated(answer))

    def close(self) -> None:
        """Leave the federation and end the broker."""
        self._take_granted()
        helics.helicsFederateDisconnect(self._federate)
        helics.helicsBrokerDisconnect(self._broker)


class WorkerFederate:
    """The federate of a worker."""

    def __init__(self, directory: Path, index: int) -> None:
        name = directory.name
        port = int((directory / _PORT).read_text())
        self._federate = _federate(f'{name}_worker_{index}', port, offset=0.5 * PERIOD)
        self._answers = helics.helicsFederateRegisterGlobalPublication(
            self._federate, _answers(index), helics.HELICS_DATA_TYPE_RAW)
        self._steps = helics.helicsFederateRegisterSubscription(self._federate, _STEPS)
        helics.helicsFederateEnterExecutingMode(self._federate)
        self._now = 0.0

    def send(self, message: bytes) -> None:
        """Publish an answer."""
        helics.helicsPublicationPublishBytes(self._answers, message)

    def receive(self, timeout_s: float) -> bytes | None:
        """Wait for the next time, without timeout, and return its step."""
        self._now = helics.helicsFederateRequestTime(self._federate, self._now + PERIOD)
        if not helics.helicsInputIsUpdated(self._steps):
            return None
        message: bytes = helics.helicsInputGetBytes(self._steps)
        return message

    def close(self) -> None:
        """Leave the federation."""
        helics.helicsFederateDisconnect(self._federate)


def coordinator_end(directory: Path, n_workers: int) -> CoordinatorFederate:
    """Start the broker and join the federation."""
    return CoordinatorFederate(directory, n_workers)


def worker_end(directory: Path, index: int) -> WorkerFederate:
    """Join the federation."""
    return WorkerFederate(directory, index)


def _answers(index: int) -> str:
    return f'answers_{index}'


def _free_port() -> int:
    """Return a free TCP port of this host."""
    with socket.socket() as probe:
        probe.bind((_HOST, 0))
        port: int = probe.getsockname()[1]
        return port


def _federate(name: str, port: int, offset: float) -> helics.HelicsFederate:
    wanted = helics.helicsCreateFederateInfo()
    helics.helicsFederateInfoSetCoreTypeFromString(wanted, CORE)
    helics.helicsFederateInfoSetCoreInitString(
        wanted,
        f'--federates=1 --broker_address={_HOST} --brokerport={port} --loglevel=no_print')
    for kind, value in ((helics.HELICS_PROPERTY_TIME_PERIOD, PERIOD),
                        (helics.HELICS_PROPERTY_TIME_OFFSET, offset)):
        helics.helicsFederateInfoSetTimeProperty(wanted, kind, value)
    return helics.helicsCreateValueFederate(name, wanted)
