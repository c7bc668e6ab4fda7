"""A node that visits the graph for one command of the command line, and waits with a deadline."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
import os
import time
from typing import Any

from isa_ros.core.suggest import alternatives
from isa_ros.errors import RunError
from isa_ros.nodes.middleware.discovery import refuse_off
from isa_ros.nodes.middleware.environment import defaults
from isa_ros.nodes.middleware.refusals import refusals
import rclpy
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions

_LOOK_S = 0.05      # longest wait between two looks at a condition


class Visitor:
    """The node, and its waits."""

    def __init__(self, node: Node, timeout_s: float) -> None:
        self.node = node
        self.timeout_s = timeout_s
        self._executor = SingleThreadedExecutor(context=node.context)
        self._executor.add_node(node)

    def wait(self, condition: Callable[[], Any], timeout_s: float | None = None) -> bool:
        """Process messages until a condition is true; False: it was not within the timeout."""
        deadline = time.monotonic() + (self.timeout_s if timeout_s is None else timeout_s)
        while not condition():
            left = deadline - time.monotonic()
            if left <= 0.0:
                return False
            self._executor.spin_once(min(left, _LOOK_S))
        return True

    def ask(self, what: str, path: str, service: str, kind: Any, request: Any,
            known: Callable[['Visitor'], Sequence[str]]) -> Any:
        """
        Return the answer of a service of a node; ``what`` it is, and those ``known`` of it.

        Raises
        ------
        ConfigError
            No node can have such a name.
        RunError
            It did not appear, or did not answer, within the timeout.

        """
        with refusals():
            client = self.node.create_client(kind, f'{path}/{service}')
        if not self.wait(client.service_is_ready):
            raise not_found(what, path, known(self), self.seconds)
        future = client.call_async(request)
        if not self.wait(future.done):
            raise RunError(f'{what} {path}: no answer within {self.seconds}')
        self.node.destroy_client(client)
        return future.result()

    def close(self) -> None:
        """End the executor."""
        self._executor.shutdown()

    @property
    def seconds(self) -> str:
        """Return the timeout for messages."""
        return f'{self.timeout_s:g} s'


@contextmanager
def visiting(timeout_s: float) -> Iterator[Visitor]:
    """
    Return a visitor of the domain that the environment names, within the context.

    Raises
    ------
    ConfigError
        Discovery is off, or the middleware cannot be started.

    """
    refuse_off('this command')
    context = Context()
    with defaults():
        with refusals():
            rclpy.init(args=[], context=context, signal_handler_options=SignalHandlerOptions.NO)
        try:
            with refusals():
                node = Node(f'isa_{os.getpid()}', context=context, enable_rosout=False,
                            start_parameter_services=False, use_global_arguments=False)
            visitor = Visitor(node, timeout_s)
            try:
                yield visitor
            finally:
                visitor.close()
                node.destroy_node()
        finally:
            rclpy.shutdown(context=context)


def absolute(name: str) -> str:
    """Return the name of a topic or node from the root: ram -> /ram."""
    return f'/{name.strip("/")}'


def not_found(what: str, name: str, known: Sequence[str], seconds: str) -> RunError:
    """Return the error about a name that did not appear in the graph in time."""
    found = alternatives(name, sorted(known)) if known else 'there is none: is a run going on'\
        ' in this ROS_DOMAIN_ID?'
    return RunError(f'{what} {name} not found within {seconds}; {found}')
