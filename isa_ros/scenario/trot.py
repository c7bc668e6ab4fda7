"""
A trot at constant speed and height: trajectories of the feet, and the joint motion of a leg.

Conventions
- Time counts in strides: a foot touches down at stride 0, lifts off at ``duty_factor``.
- The foot is given relative to the hip: x forward, z up (m), in the plane of the leg at HAA = 0.
  Joint angles and torques have the signs of scripts/generate_leg.py; the knee is bent, KFE < 0.
- Diagonal legs move alike, the two pairs half a stride apart.

Equations G1-G6 of docs/equations.md. Neglected: pitch, roll and bobbing of the body, the
horizontal forces that the standing legs exert for the swinging ones, impact at touch-down.
"""

import math
from typing import NamedTuple

from isa_ros.core.constants import STANDARD_GRAVITY
from isa_ros.core.elementary import acos, atan2, cos, sin
from isa_ros.core.frozen import frozen
from isa_ros.core.parameter import parameter, Parameters
from isa_ros.core.remembered import remembered
from isa_ros.errors import ConfigError
from isa_ros.surroundings.bodies.leg.dynamics import leg_terms
from isa_ros.surroundings.bodies.leg.sheet import body_record, LegSheet
import numpy as np

CHECKED_INSTANTS = 400  # of a stride, at which a leg must reach its foothold
LEGS_OF_A_PAIR = 2


@frozen(kw_only=True)
class TrotParameters(Parameters):
    """Parameters of a trot."""

    forward_speed: float = parameter('speed of the body', 'm/s', ge=0.0, le=5.0)
    step_frequency_hz: float = parameter('strides of one leg', 'Hz', ge=0.1, le=5.0)
    duty_factor: float = parameter('part of a stride that a foot stands', '1', ge=0.51, le=0.95)
    step_height: float = parameter('lift of a swinging foot', 'm', ge=0.0, le=0.5)
    hip_height: float = parameter('hip above the ground', 'm', gt=0.0, le=2.0)
    robot_mass: float = parameter(
        'mass the feet carry, legs included; 0: in the air', 'kg', ge=0.0, le=1000.0)


class Foot(NamedTuple):
    """A foot relative to the hip: position (m), speed, acceleration, load upwards (N)."""

    x: float
    z: float
    v_x: float
    v_z: float
    a_x: float
    a_z: float
    load: float


class Joints(NamedTuple):
    """Angles (rad), speeds (rad/s) and torques (Nm) in the order of the leg's joints."""

    angle: tuple[float, float, float]
    speed: tuple[float, float, float]
    torque: tuple[float, float, float]


def smooth_step(u: float) -> tuple[float, float, float]:
    """Return w = u^3 (10 - 15 u + 6 u^2), w', w'' of 0 <= u <= 1  (G1); ends at rest."""
    rest = 1.0 - u
    return (u * u * u * (10.0 + u * (6.0 * u - 15.0)), 30.0 * u * u * rest * rest,
            60.0 * u * rest * (1.0 - 2.0 * u))


def foot_at(trot: TrotParameters, stride: float) -> Foot:
    """
    Return the foot at a time in strides.

    It stands, x = L/2 - v t with L = v d/f  (G2), or swings with u from 0 to 1,
    x = -L/2 - v (1 - d)/f u + v/f w(u), z = -H + 64 h u^3 (1 - u)^3  (G3): position, speed
    and acceleration have no jump.
    """
    part = stride - math.floor(stride)
    advance = trot.forward_speed / trot.step_frequency_hz  # of the body in a stride, m
    half = 0.5 * advance * trot.duty_factor
    load = _share(part, trot.duty_factor) * trot.robot_mass * STANDARD_GRAVITY / LEGS_OF_A_PAIR
    if part < trot.duty_factor:
        return Foot(half - advance * part, -trot.hip_height, -trot.forward_speed, 0.0, 0.0, 0.0,
                    load)
    swing = 1.0 - trot.duty_factor
    u = (part - trot.duty_factor) / swing
    rate = trot.step_frequency_hz / swing
    w, w_1, w_2 = smooth_step(u)
    arch = u * (1.0 - u)
    slope = 1.0 - 2.0 * u
    lift = 64.0 * trot.step_height
    return Foot(
        -half - advance * swing * u + advance * w,
        -trot.hip_height + lift * arch * arch * arch,
        -trot.forward_speed + advance * w_1 * rate, 3.0 * lift * arch * arch * slope * rate,
        advance * w_2 * rate * rate,
        6.0 * lift * arch * (slope * slope - arch) * rate * rate, load)


def _share(part: float, duty_factor: float) -> float:
    """
    Return the part of the weight that the foot's pair carries  (G4).

    While all feet stand, the share of the pair that has touched down grows with w; the shares
    of both pairs add up to 1 at any time.
    """
    overlap = duty_factor - 0.5
    if part < overlap:
        return smooth_step(part / overlap)[0]
    if part < 0.5:
        return 1.0
    if part < duty_factor:
        return 1.0 - smooth_step((part - 0.5) / overlap)[0]
    return 0.0


def leg_angles(x: float, z: float, thigh: float, calf: float) -> tuple[float, float]:
    """
    Return HFE and KFE (rad) that put the foot at x, z (m) from the hip, links in m  (G5).

    cos(KFE) = (x^2 + z^2 - l_t^2 - l_c^2)/(2 l_t l_c), KFE < 0, and
    HFE = atan2(-x, -z) - atan2(l_c sin(KFE), l_t + l_c cos(KFE)).

    Raises
    ------
    ConfigError
        The foot is out of reach.

    """
    cosine = (x * x + z * z - thigh * thigh - calf * calf) / (2.0 * thigh * calf)
    if not -1.0 <= cosine <= 1.0:
        raise ConfigError(
            f'the foot is {math.hypot(x, z):.4g} m from the hip, must be '
            f'{abs(thigh - calf):.4g} to {thigh + calf:.4g} m, the reach of the leg')
    kfe = -acos(cosine)
    return (atan2(-x, -z)
            - atan2(calf * sin(kfe), thigh + calf * cos(kfe))), kfe


class TrottingLeg:
    """
    One leg of a trot; ``stride`` of its methods is a time in strides.

    Raises
    ------
    ConfigError
        The leg does not reach its footholds within the ranges of its joints.

    """

    def __init__(self, trot: TrotParameters, sheet: LegSheet) -> None:
        self._trot = trot
        self._body = body_record(sheet.body)[0]
        self._thigh, self._calf = sheet.body.thigh.length_m, sheet.body.calf.length_m
        self._refuse_reach(sheet)
        self._last: tuple[float, Joints] | None = None

    def _refuse_reach(self, sheet: LegSheet) -> None:
        cause = (f'forward_speed = {self._trot.forward_speed:g} m/s at step_frequency_hz = '
                 f'{self._trot.step_frequency_hz:g} Hz')
        try:
            angles = np.degrees([
                (0.0, *self._angles(foot_at(self._trot, k / CHECKED_INSTANTS)))
                for k in range(CHECKED_INSTANTS)])
        except ConfigError as error:
            raise ConfigError(f'{cause}: {error}') from error
        for (name, joint), taken in zip(sheet.joints.items(), angles.T):
            if not (joint.low_deg <= taken.min() and taken.max() <= joint.high_deg):
                raise ConfigError(
                    f'{cause} moves {name} from {taken.min():.4g} to {taken.max():.4g} deg, must '
                    f'stay within its {joint.low_deg:g} to {joint.high_deg:g} deg')

    def _angles(self, foot: Foot) -> tuple[float, float]:
        return leg_angles(foot.x, foot.z, self._thigh, self._calf)

    def at(self, stride: float) -> Joints:
        """Return the joints, once computed for all whose motions ask at the same stride."""
        if self._last is None or stride != self._last[0]:
            self._last = stride, self._joints(stride)
        return self._last[1]

    def _joints(self, stride: float) -> Joints:
        """
        Return the joints: speeds from J q' = v, torques M q'' + h - J^T f  (G6).

        The divisor sin(KFE) is not 0: a straight or folded knee lies outside its range.
        """
        foot = foot_at(self._trot, stride)
        hfe, kfe = self._angles(foot)
        s_t, c_t = self._thigh * sin(hfe), self._thigh * cos(hfe)
        s_c, c_c = self._calf * sin(hfe + kfe), self._calf * cos(hfe + kfe)
        scale = 1.0 / (self._thigh * self._calf * sin(kfe))

        def solved(x: float, z: float) -> tuple[float, float]:
            """Return the rates of HFE and of KFE that move the foot by (x, z)."""
            calf = scale * (s_t * x + c_t * z)
            thigh = -scale * (s_c * x + c_c * z)
            return thigh, calf - thigh

        v_hfe, v_kfe = solved(foot.v_x, foot.v_z)
        thigh, calf = v_hfe * v_hfe, (v_hfe + v_kfe) * (v_hfe + v_kfe)
        a_hfe, a_kfe = solved(
            foot.a_x - s_t * thigh - s_c * calf, foot.a_z - c_t * thigh - c_c * calf)
        terms = leg_terms(0.0, 0.0, hfe, kfe, 0.0, 0.0, v_hfe, v_kfe, self._body)
        return Joints((0.0, hfe, kfe), (0.0, v_hfe, v_kfe), (
            terms.m_haa_hfe * a_hfe + terms.m_haa_kfe * a_kfe + terms.h_haa
            - terms.j_z_haa * foot.load,
            terms.m_hfe_hfe * a_hfe + terms.m_hfe_kfe * a_kfe + terms.h_hfe
            - terms.j_z_hfe * foot.load,
            terms.m_hfe_kfe * a_hfe + terms.m_kfe_kfe * a_kfe + terms.h_kfe
            - terms.j_z_kfe * foot.load))


@remembered
def trotting_leg(trot: TrotParameters, sheet: LegSheet) -> TrottingLeg:
    """Return the leg of a trot, the same one for the motions of all its joints; raises as it."""
    return TrottingLeg(trot, sheet)
