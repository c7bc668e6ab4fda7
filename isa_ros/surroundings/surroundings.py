"""
What the actuators of one run have in common: the supply, and the leg where there is one.

The coordinator's side of the load port (equation L1), and the messages that show it.
"""

import math

from isa_ros.config.run_config import LegConfig, RunConfig
from isa_ros.core.signals import START
from isa_ros.core.timebase import NS_PER_SECOND
from isa_ros.core.units import MPA
from isa_ros.errors import ConfigError
from isa_ros.loads.sheets import static_force
from isa_ros.plant.plant import plant_record
from isa_ros.plant.servo_valve import largest_flow_slope
from isa_ros.run.exchange import Messages, Records
from isa_ros.surroundings.leg.leg import Leg, Pose
from isa_ros.surroundings.leg.sheet import JOINTS
from isa_ros.surroundings.supply import Supply
from msg_adapters import clock, event, fluid_pressure, joint_state, wrench
from msg_adapters.coordinator_messages import ClockMessage, LegMessages, SupplyMessages
import numpy as np

CLOCK_TOPIC = ('/clock', clock.TYPE)
EVENT_TOPIC = ('/coordinator/events', event.TYPE)
SUPPLY_TOPIC = ('/coordinator/supply_pressure', fluid_pressure.TYPE)
JOINT_TOPIC = ('/joint_states', joint_state.TYPE)
CONTACT_TOPIC = ('/coordinator/ground_contact', wrench.TYPE)

_SHOWN = {'joint_position': 'position', 'joint_velocity': 'velocity', 'joint_torque': 'torque',
          'foot_force': 'foot_force'}
"""Field of the leg's sample by that of `SHARED_SAMPLE`."""


class SharedLoad:
    """Supply and leg of a run; see `isa_ros.run.exchange.SharedLoad`."""

    def __init__(self, run: RunConfig) -> None:
        self._step_ns = run.step_ns
        span = (run.supply.pressure_mpa - run.supply.return_pressure_mpa) * MPA
        slope = sum(largest_flow_slope(plant_record(a.sheet.plant)[0].valve, span)
                    for a in run.actuators)
        self._supply = Supply(run.supply, run.step_ns, slope)
        self._leg: Leg | None = None
        self._release_ns = 0
        self._t_ns = 0
        if run.leg is not None:
            self._leg = _leg(run, run.leg)
            self._release_ns = round(run.leg.start.release_s * NS_PER_SECOND)
        self._clock = ClockMessage()
        self._supply_alone = SupplyMessages()
        self._with_leg = LegMessages(JOINTS)

    @property
    def topics(self) -> tuple[tuple[str, str], ...]:
        """Return (name, type) of what `messages` gives, in its order."""
        if self._leg is None:
            return (SUPPLY_TOPIC,)
        return SUPPLY_TOPIC, JOINT_TOPIC, CONTACT_TOPIC

    def ports(self, ports: Records) -> None:
        """Fill the `LOAD_PORT` of every actuator for the next tick, shape (n_actuators,)."""
        ports['supply_pressure'] = self._supply.pressure
        ports['return_pressure'] = self._supply.return_pressure
        if self._leg is not None:
            if self._leg.is_held and self._t_ns >= self._release_ns:
                self._leg.release()
            self._leg.ports(ports)

    def advance(self, replies: Records) -> None:
        """
        Advance leg and supply by one tick under the `LOAD_REPLY` of every actuator.

        Raises
        ------
        SimulationDiverged
            A state of the leg is no longer finite.

        """
        if self._leg is not None:
            self._leg.advance(replies)
        self._supply.advance(sum(replies['supply_volume'].tolist()))
        self._t_ns += self._step_ns

    def show(self, shared: Records) -> None:
        """Fill the `SHARED_SAMPLE` of this instant, shape (1,)."""
        shared['supply_pressure'] = self._supply.pressure
        for shown, name in _SHOWN.items():
            shared[shown] = math.nan if self._leg is None else self._leg.sample[name]

    def clock(self, t_ns: int) -> bytes:
        """Return the `/clock` message of ``t_ns``."""
        return self._clock.pack(t_ns)

    def event(self, t_ns: int, text: str) -> bytes:
        """Return the message that says what was done to the run at ``t_ns``."""
        return event.pack(t_ns, text)

    def snapshot(self) -> bytes:
        """Return the whole state; `restore` continues from it byte for byte."""
        leg = b'' if self._leg is None else self._leg.state()
        return self._t_ns.to_bytes(8, 'little') + self._supply.state() + leg

    def restore(self, snapshot: bytes) -> None:
        """
        Continue from a `snapshot` of the same configuration.

        Raises
        ------
        ConfigError
            It is none.

        """
        here = len(self.snapshot())
        if len(snapshot) != here:
            raise ConfigError(
                f'saved state of the load: {len(snapshot)} bytes, must be {here}')
        supply_end = 8 + len(self._supply.state())
        self._t_ns = int.from_bytes(snapshot[:8], 'little')
        self._supply.restore(snapshot[8:supply_end])
        if self._leg is not None:
            self._leg.restore(snapshot[supply_end:])

    def messages(self, t_ns: int) -> Messages:
        """Return the messages of this instant in the order of `topics`."""
        if self._leg is None:
            return self._supply_alone.pack(self._supply.pressure, t_ns)
        return self._with_leg.pack(self._supply.pressure, self._leg.shown, t_ns)

    def starts(self, run: RunConfig) -> Records:
        """
        Return the `START` of every actuator, shape (n_actuators,).

        At a joint of the leg the actuator carries it: its sensor is strained by the force
        it holds, so the piston or rotor stands beside the load by force over stiffness (S1).
        """
        starts = np.zeros(len(run.actuators), START)
        starts['position'] = [actuator.initial_position for actuator in run.actuators]
        starts['force'] = [static_force(actuator.load) for actuator in run.actuators]
        starts['supply_pressure'] = self._supply.pressure
        starts['return_pressure'] = self._supply.return_pressure
        if self._leg is not None and run.leg is not None:
            rows = [run.index(name) for _, name in run.leg.joints]
            for row, x, force in zip(
                    rows, self._leg.actuator_positions, self._leg.actuator_forces):
                k_s = plant_record(run.actuators[row].sheet.plant)[0].mechanics.k_s
                starts[row]['position'] = x + force / k_s
                starts[row]['force'] = force
        return starts


def _leg(run: RunConfig, leg: LegConfig) -> Leg:
    start = leg.start
    pose = Pose(haa=start.angle('haa'), hfe=start.angle('hfe'), kfe=start.angle('kfe'),
                foot_height=start.foot_height_mm * 1e-3)
    return Leg(leg.sheet, pose, run.step_ns, [run.index(name) for _, name in leg.joints])
