"""A controller in the lockstep: sway the hip, independently of the host's timing."""

from collections.abc import Mapping
import math

from isa_ros.controller import Controller, Setpoint, State


class Sway(Controller):
    """Move HFE as a sine, against the torque it measures."""

    def step(self, state: State) -> Mapping[str, Setpoint]:
        """Return the setpoint of the next tick from the state of this one."""
        hfe = state.actuators['hfe']
        sine = 0.004 * math.sin(2.0 * math.pi * 1.5 * state.t_ns * 1e-9)
        return {'hfe': Setpoint(position=0.038 + sine, effort=-0.1 * hfe.force)}

    def snapshot(self) -> bytes:
        """Return nothing: everything it needs is in the state."""
        return b''

    def restore(self, snapshot: bytes) -> None:
        """Do nothing: there is nothing to restore."""


if __name__ == '__main__':
    from isa_ros.nodes import Participant
    import rclpy

    rclpy.init()
    Participant(rclpy.create_node('sway'), Sway()).spin()
