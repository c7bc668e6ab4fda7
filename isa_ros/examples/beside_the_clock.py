"""A controller outside the lockstep: it follows /clock, and the run does not wait for it."""

from contextlib import suppress
import math

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import JointState

PERIOD_NS = 10_000_000


class BesideTheClock(Node):
    """Sway HFE every 10 ms of simulated time; applied setpoints are echoed and recorded."""

    def __init__(self) -> None:
        super().__init__('beside_the_clock')
        self._due_ns = 0
        self._setpoints = self.create_publisher(JointState, '/hfe/setpoint', 1)
        self.create_subscription(Clock, '/clock', self._on_clock, 10)

    def _on_clock(self, message: Clock) -> None:
        t_ns = message.clock.sec * 10**9 + message.clock.nanosec
        if self._due_ns - PERIOD_NS <= t_ns < self._due_ns:
            return  # not due yet; after a restart of the run the next setpoint is due at once
        self._due_ns = t_ns + PERIOD_NS
        position = 0.038 + 0.004 * math.sin(2.0 * math.pi * 1.5 * t_ns * 1e-9)
        self._setpoints.publish(JointState(name=['hfe'], position=[position]))


if __name__ == '__main__':
    rclpy.init()
    with suppress(KeyboardInterrupt, ExternalShutdownException):  # a signal ends the node
        rclpy.spin(BesideTheClock())
