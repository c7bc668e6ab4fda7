"""
Floor of every exchange: pipes to processes that only answer.

The processes import this module, which is why it imports little.
"""

from multiprocessing import get_context
from multiprocessing.connection import Connection

from isa_ros.bench.row import seconds
from isa_ros.core.signals import LOAD_REPLY, SAMPLE

TICKS = 500
WORKERS = 3             # number of the leg's actuators
PIPE_BYTES = LOAD_REPLY.itemsize + SAMPLE.itemsize     # size of one actuator's answer


def pipe_exchange() -> float:
    """Return the time of one exchange with `WORKERS` processes that only answer, in s."""
    context = get_context('spawn')
    pipes = [context.Pipe() for _ in range(WORKERS)]
    workers = [context.Process(target=_answer, args=(theirs,)) for _, theirs in pipes]
    for worker in workers:
        worker.start()
    payload = bytes(PIPE_BYTES)

    def exchange() -> None:
        for _ in range(TICKS):
            for ours, _ in pipes:
                ours.send_bytes(payload)
            for ours, _ in pipes:
                ours.recv_bytes()
    result = seconds(exchange, TICKS)
    for (ours, _), worker in zip(pipes, workers):
        ours.send_bytes(b'')
        worker.join()
    return result


def _answer(pipe: Connection) -> None:
    while message := pipe.recv_bytes():
        pipe.send_bytes(message)
