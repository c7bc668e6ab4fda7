"""A controller that asks for millimetres now and then: python -m tests.ros.in_millimetres."""

from collections.abc import Mapping

from isa_ros.controller import Setpoint, State
from isa_ros.examples.sway import Sway


class InMillimetres(Sway):
    """Ask for the places of `Sway`, in each tenth tick a thousand times as far."""

    def step(self, state: State) -> Mapping[str, Setpoint]:
        """Return the setpoint of the next tick from the state of this one."""
        asked = super().step(state)
        if state.t_ns // 1_000_000 % 10:
            return asked
        return {name: own._replace(position=1e3 * own.position) for name, own in asked.items()}


if __name__ == '__main__':
    from isa_ros.nodes import Participant
    import rclpy

    rclpy.init()
    Participant(rclpy.create_node('sway'), InMillimetres()).spin()
