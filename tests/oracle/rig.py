"""One leg with three actuators, through the load port and as one ODE, from the same start."""

from dataclasses import dataclass, field
import math

from isa_ros.actuator.actuator import SmartActuator
from isa_ros.actuator.sheet import ActuatorSheet
from isa_ros.actuator.timing import Timing
from isa_ros.config.runs.run_config import ActuatorConfig
from isa_ros.core.signals import LOAD_PORT, LOAD_REPLY
from isa_ros.surroundings.bodies.leg.leg import Leg, LegPose
from isa_ros.surroundings.bodies.leg.sheet import LegSheet
import numpy as np
from tests.legs import leg_sheet
from tests.oracle.monolith import monolith, ROW_NS, TRACE
from tests.sheets import actuator_sheet, setpoint

WINDOWS = 5


def hanging(foot_height: float) -> LegPose:
    """Return the pose of the shipped drop with the foot elsewhere above the ground (m)."""
    return LegPose(haa=0.0, hfe=math.radians(41.3), kfe=math.radians(-80.0),
                   foot_height=foot_height)


@dataclass
class Rig:
    """HAA smart manifold, HFE and KFE ISA v5 on the HyQ-REAL leg, constant supply."""

    pose: LegPose
    leg: LegSheet = field(default_factory=leg_sheet)
    sheets: tuple[ActuatorSheet, ...] = field(default_factory=lambda: (
        actuator_sheet('smart_manifold'), actuator_sheet('isa_v5'), actuator_sheet('isa_v5')))
    supply_pressure: float = 20.7e6
    controller_offset_ns: int = 120_000
    command_ns: int = 2_000_000

    def start(self, step_ns: int) -> tuple[list[SmartActuator], Leg]:
        """Return actuators and leg at t = 0."""
        leg = Leg(self.leg, self.pose, step_ns)
        actuators = []
        for name, sheet, x, force in zip(
                ('haa', 'hfe', 'kfe'), self.sheets, leg.actuator_positions, leg.actuator_forces):
            model = 'smart_manifold' if sheet.is_rotary else 'isa_v5'
            actuator = SmartActuator(
                ActuatorConfig(name, model, 'default', sheet, None, x),
                Timing(step_ns, self.controller_offset_ns))
            k_s = sheet.plant.mechanics.sensor_stiffness
            actuator.start(x + force / k_s, force, self.supply_pressure, 0.0)
            actuators.append(actuator)
        return actuators, leg

    def hold(self, duration_ns: int) -> np.ndarray:
        """Return commands that hold the start with the sheets' gains, (n, 3, 5)."""
        actuators, _ = self.start(1_000_000)
        commands = np.zeros((duration_ns // self.command_ns + 1, 3, 5))
        for j, (actuator, sheet) in enumerate(zip(actuators, self.sheets)):
            gains = sheet.reu.position
            commands[:, j, 0] = actuator.sample['position']
            commands[:, j, 3], commands[:, j, 4] = gains.stiffness, gains.damping
        return commands

    def one_ode(self, commands: np.ndarray, duration_ns: int, release_ns: int,
                aside: float = 0.0) -> np.ndarray:
        """
        Return the oracle's `TRACE`, one row per `ROW_NS`.

        ``aside`` (m | rad) displaces pistons and rotor at the start.
        """
        actuators, leg = self.start(1_000_000)
        return monolith(
            self, actuators, leg, commands, duration_ns // ROW_NS, release_ns, aside)

    def coupled(self, commands: np.ndarray, duration_ns: int, release_ns: int,
                step_ns: int) -> np.ndarray:
        """
        Return the `TRACE` through the load port, one row per window of a fifth of ``step_ns``.

        Angles and end forces are known at ticks only; the rows between carry NaN.
        """
        actuators, leg = self.start(step_ns)
        n = duration_ns // step_ns
        trace = np.zeros(n * WINDOWS, TRACE)
        for name in ('force', 'angle', 'normal', 'work'):
            trace[name] = np.nan
        ports, replies = np.zeros(3, LOAD_PORT), np.zeros(3, LOAD_REPLY)
        ports['supply_pressure'] = self.supply_pressure
        work, x = np.zeros(3), np.array(leg.actuator_positions)
        for k in range(n):
            t_ns = k * step_ns
            if leg.is_held and t_ns >= release_ns:
                leg.release()
            leg.ports(ports)
            for j, actuator in enumerate(actuators):
                if t_ns % self.command_ns == 0:
                    position, velocity, effort, stiffness, damping = commands[
                        t_ns // self.command_ns, j]
                    actuator.accept(setpoint(
                        position=position, velocity=velocity, effort=effort,
                        stiffness=stiffness, damping=damping))
                actuator.tick(ports[j])
                replies[j] = actuator.reply
            leg.advance(replies)
            rows = trace[k * WINDOWS:(k + 1) * WINDOWS]
            rows['mean'] = replies['mean_forces'].T
            before, x = x, np.array(leg.actuator_positions)
            work += replies['mean_forces'].mean(axis=1) * (x - before)
            last = rows[-1:]
            last['force'] = replies['force']
            last['angle'] = leg.sample[0]['position']
            last['normal'], last['work'] = leg.sample[0]['foot_force'][2], work
        return trace
