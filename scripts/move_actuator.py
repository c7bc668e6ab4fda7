"""
Send one position setpoint to an actuator node and print the applied one.

    python scripts/move_actuator.py NAME POSITION     (m, or rad for a rotary actuator)
"""

import argparse
import sys
import time

import rclpy
from rclpy.qos import QoSProfile
from sensor_msgs.msg import JointState

TIMEOUT_S = 10.0


def main() -> int:
    """Publish once there is a subscriber, then wait for the applied setpoint."""
    parser = argparse.ArgumentParser(description='Send one position setpoint.')
    parser.add_argument('name')
    parser.add_argument('position', type=float, help='m, or rad for a rotary actuator')
    options = parser.parse_args()
    name, position = options.name, options.position
    rclpy.init()
    node = rclpy.create_node('move_actuator')
    applied: list[JointState] = []

    def on_echo(message: JointState) -> None:
        if message.position[0] == position:  # not the start position
            applied.append(message)
    node.create_subscription(
        JointState, f'/{name}/applied_setpoint', on_echo, QoSProfile(depth=10))
    publisher = node.create_publisher(JointState, f'/{name}/setpoint', QoSProfile(depth=1))
    deadline = time.monotonic() + TIMEOUT_S
    has_sent = False
    while not applied and time.monotonic() < deadline:
        ready = publisher.get_subscription_count() and node.count_publishers(
            f'/{name}/applied_setpoint')
        if ready and not has_sent:
            publisher.publish(JointState(name=[name], position=[position]))
            has_sent = True
        rclpy.spin_once(node, timeout_sec=0.1)
    if not applied:
        print(f'/{name}: no applied setpoint after {TIMEOUT_S:g} s', file=sys.stderr)
        return 3
    stamp = applied[0].header.stamp
    print(f'{name} = {applied[0].position[0]} since t = {stamp.sec}.{stamp.nanosec:09d} s')
    return 0


if __name__ == '__main__':
    sys.exit(main())
