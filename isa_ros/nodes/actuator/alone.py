"""One actuator alone: it advances by itself, at a multiple of real time."""

from collections.abc import Callable
import time
from typing import Any

from isa_ros.core.timebase import NS_PER_SECOND
from isa_ros.errors import ConfigError
from isa_ros.nodes.actuator.node import ActuatorNode
from isa_ros.nodes.middleware.discovery import is_off
from rclpy.experimental.events_executor import EventsExecutor

BURST_TICKS = 20        # ticks between two checks for setpoints, services and signals
LARGEST_LAG_S = 0.5     # a longer delay is skipped instead of made up for
WARNING_PERIOD_S = 10.0
EXAMPLE = 0.1            # of the stroke: the move in the line that says how to command it


def run_alone(
        node: ActuatorNode, real_time_factor: float, should_stop: Callable[[], bool],
        ros_time: bool = False) -> None:
    """
    Advance ``node`` until ``should_stop`` at ``real_time_factor``; 0: as fast as possible.

    ``ros_time``: stamps are of the host's clock, as ROS time is without simulated time; otherwise
    they are of the simulation time, from 0.

    Raises
    ------
    ConfigError
        The factor is negative or not finite, or is not 1 with ``ros_time``.
    SimulationDiverged
        A state is no longer finite.

    """
    if not 0.0 <= real_time_factor < float('inf'):
        raise ConfigError(
            f'{node.get_name()}: real_time_factor = {real_time_factor:g}, must be finite and '
            '>= 0')
    if ros_time and real_time_factor != 1.0:
        raise ConfigError(
            f'{node.get_name()}: real_time_factor = {real_time_factor:g}, must be 1 with ros_time')
    node.warm_up()
    executor: Any = EventsExecutor(context=node.context)
    executor.add_node(node)
    if ros_time:
        node.stamp_from(time.time_ns())
    node.publish()
    node.get_logger().info(ready_text(node, real_time_factor))
    step_s = node.setup.timing.step_ns / NS_PER_SECOND
    tick, began = 0, time.monotonic()
    try:
        while not should_stop():
            wait = 0.0
            due = tick + BURST_TICKS
            if real_time_factor:
                elapsed = (time.monotonic() - began) * real_time_factor
                due = int(elapsed / step_s)
                lag = elapsed - tick * step_s
                if lag > LARGEST_LAG_S * real_time_factor:
                    began += lag / real_time_factor
                    if ros_time:
                        node.stamp_from(time.time_ns())
                    node.get_logger().warning(
                        f'{lag:.1f} s of simulated time behind real_time_factor = '
                        f'{real_time_factor:g}; the delay is not made up for',
                        throttle_duration_sec=WARNING_PERIOD_S)
                    continue
                wait = max(0.0, ((tick + 1) * step_s - elapsed) / real_time_factor)
            for _ in range(min(due - tick, BURST_TICKS)):
                node.actuator.tick()
                node.publish()
                tick += 1
            executor.spin_once(min(wait, LARGEST_LAG_S) if due <= tick else 0.0)
            node.check_publishers()
    finally:
        executor.remove_node(node)
        executor.shutdown()


def ready_text(node: ActuatorNode, real_time_factor: float) -> str:
    """Return what runs, on which topics, and a command that moves it, in one line."""
    config = node.setup.config
    name = config.name
    states, *commanded = map(
        node.resolve_topic_name, ('~/joint_states', '~/setpoint', '~/applied_setpoint'))
    stroke, unit = config.sheet.plant.drive.stroke, 'rad' if config.sheet.is_rotary else 'm'
    position = float(node.actuator.memory.observed[0]['position'])
    target = position + (EXAMPLE if position < 0.5 * stroke else -EXAMPLE) * stroke
    pace = f'{real_time_factor:g} times real time' if real_time_factor else 'maximum speed'
    path = node.get_fully_qualified_name()
    is_remapped = commanded != [f'{path}/setpoint', f'{path}/applied_setpoint']
    own = '' if is_remapped else f'isa command {path[1:]} {target:.4g}, or '
    text = (f'ready at {pace}: position {position:.4g} of 0 to {stroke:.4g} {unit} on '
            f'{states}; to move it: {own}ros2 topic pub --once '
            f"{commanded[0]} sensor_msgs/msg/JointState '{{name: [{name}], position: "
            f"[{target:.4g}]}}'")
    return f'{text}; discovery is off, so that only this process can' if is_off() else text
