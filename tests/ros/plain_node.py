"""
A user's node without any setting of this package: python -m tests.ros.plain_node NAME POSITION.

Repeats a setpoint until it has read the actuator's state and the echo of that setpoint.
"""

import sys

import rclpy
from sensor_msgs.msg import JointState
from tests.ros.started import wait_for


def main(name: str, position: float) -> None:
    """Send, and subscribe to both topics."""
    rclpy.init()
    node = rclpy.create_node('plain')
    states: list[JointState] = []
    echoes: list[JointState] = []
    node.create_subscription(JointState, f'/{name}/joint_states', states.append, 10)
    node.create_subscription(JointState, f'/{name}/applied_setpoint', echoes.append, 10)
    publisher = node.create_publisher(JointState, f'/{name}/setpoint', 1)

    def is_answered() -> bool:
        publisher.publish(JointState(name=[name], position=[position]))
        rclpy.spin_once(node, timeout_sec=0.01)
        return bool(states) and any(echo.position[0] == position for echo in echoes)
    wait_for(is_answered, 'the answer')


if __name__ == '__main__':
    main(sys.argv[1], float(sys.argv[2]))
