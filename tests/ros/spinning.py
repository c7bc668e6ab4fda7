"""A node of a test whose callbacks run while it waits."""

from typing import Any

from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from tests.ros.started import wait_for


class Spinning:
    """Spins one node on an executor of its own."""

    def __init__(self, node: Node) -> None:
        self._executor = SingleThreadedExecutor(context=node.context)
        self._executor.add_node(node)

    def spin_once(self) -> None:
        """Run the callbacks of messages that have arrived, or arrive within 10 ms."""
        self._executor.spin_once(0.01)

    def wait_for(self, condition: Any, what: str) -> None:
        """Spin until ``condition``."""
        def spin() -> bool:
            self.spin_once()
            return bool(condition())
        wait_for(spin, what)
