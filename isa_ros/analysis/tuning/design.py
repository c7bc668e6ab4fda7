"""
Gains for a wanted margin and bandwidth, from the plant's response at each place of the stroke.

With U = C_r R - C_y Y of the block and Y = P U of everything behind it, the closed loop is
T = P C_r / (1 + P C_y), the open loop that `isa bode` shows L = T / (1 - T), and the loop broken
at the block's output P C_y. P follows from a measured T; T and L with other gains from P.

K_f and K_i / K_p are common to the stroke. At each place the factor on all gains gives the wanted
bandwidth. At that bandwidth more K_f gives more margin, a faster integral less; of the pairs of
both the one whose margins over the stroke are closest to the wanted one is taken.
"""

from collections.abc import Sequence
from dataclasses import replace
import math

from isa_ros.analysis.signals.frequency import bandwidth, margins, Response
from isa_ros.analysis.tuning.block_response import ResponseParts
from isa_ros.core.frozen import frozen
import numpy as np
from scipy.interpolate import PchipInterpolator
from scipy.optimize import brentq, minimize

DENSE = 240             # points of a predicted response
LEAST_GAIN_MARGIN = 6.0     # dB, of L and of the loop broken at the block's output
LARGEST_KF = 4.0        # K_f over 1 / w, w that of the wanted bandwidth
KFS = np.linspace(0.0, 0.5, 11) * LARGEST_KF    # where the search begins
CORNERS = (0.025, 0.05, 0.1, 0.2, 0.4, 0.8)     # of the integral, K_i / K_p over w
CLOSE = 0.4             # of the tolerated error: below it only the costs of K_f and corner count
KF_COST, CORNER_COST = 0.05, 0.1    # of K_f w, and of a corner e times another, in that error
RANGE = 30.0            # factor by which gains are searched up and down
NUDGES = np.linspace(0.85, 1.15, 31)    # of K_p at a place, around that of the wanted bandwidth
STEEP = 10.0            # cost of an error beyond what is tolerated, to that of one within it
TOLERATED_DEG, TOLERATED_SHARE = 5.0, 0.1   # error of the margin; of the bandwidth as a share


@frozen
class WantedLoop:
    """The aim: phase margin of L in degrees, -3 dB of the closed loop in Hz."""

    phase_margin: float
    bandwidth: float


@frozen
class Plant:
    """The response P at one place, from the block's demand to its measured value."""

    frequency: np.ndarray
    value: np.ndarray

    def at(self, frequency: np.ndarray) -> np.ndarray:
        """Return the response between its points: log gain and phase over log frequency."""
        x = np.log(self.frequency)
        log_gain, phase = np.log(np.abs(self.value)), np.unwrap(np.angle(self.value))
        found: np.ndarray = np.exp(
            PchipInterpolator(x, log_gain)(np.log(frequency))
            + 1j * PchipInterpolator(x, phase)(np.log(frequency)))
        return found


def plant_of(closed: Response, of_reference: np.ndarray, of_measured: np.ndarray) -> Plant:
    """Return P = T / (C_r - T C_y) from a measured closed loop and its block's responses."""
    kept = closed.is_trusted
    value = closed.value / (of_reference - closed.value * of_measured)
    return Plant(closed.frequency[kept], value[kept])


@frozen
class Gains:
    """K_f and the integral's corner (1/s) for the stroke, and K_p at each place."""

    kf: float
    corner: float
    kp: np.ndarray


@frozen
class Prediction:
    """The loop at one place with some gains."""

    bandwidth: float | None
    phase_margin: float | None
    is_robust: bool
    """Whether both gain margins are at least `LEAST_GAIN_MARGIN`."""


class LoopAtPlace:
    """The loop at one place of the stroke, for any gains."""

    def __init__(self, plant: Plant, of_reference: ResponseParts, of_measured: ResponseParts,
                 frequency: np.ndarray) -> None:
        self._plant = plant.at(frequency)
        self._of_reference, self._of_measured = of_reference, of_measured
        self._frequency = frequency

    def closed(self, kp: float, corner: float, kf: float) -> np.ndarray:
        """Return T."""
        gains = kp, corner * kp, kf
        value: np.ndarray = self._plant * self._of_reference.at(*gains) / (
            1.0 + self._plant * self._of_measured.at(*gains))
        return value

    def predicted(self, kp: float, corner: float, kf: float) -> Prediction:
        """Return bandwidth and margins."""
        closed = self.closed(kp, corner, kf)
        opened = margins(self._response(closed / (1.0 - closed)))
        broken = margins(self._response(
            self._plant * self._of_measured.at(kp, corner * kp, kf)))
        return Prediction(
            bandwidth(self._response(closed), 1.0), opened.phase,
            all(gain is None or gain >= LEAST_GAIN_MARGIN
                for gain in (opened.gain_db, broken.gain_db))
            and all(phase is not None and phase > 0.0 for phase in (opened.phase, broken.phase)))

    def kp_for(self, wanted: float, corner: float, kf: float, near: float) -> float | None:
        """Return K_p for a bandwidth within `RANGE` of ``near``; None: no gain has it."""
        def excess(log_kp: float) -> float:
            closed = self.closed(math.exp(log_kp), corner, kf)
            found = bandwidth(self._response(closed), 1.0)
            if found is None:   # outside of the band, below or above it
                edge = 0 if abs(closed[0]) < 1.0 / math.sqrt(2.0) else -1
                found = float(self._frequency[edge])
            return math.log(found / wanted)
        low, high = math.log(near / RANGE), math.log(near * RANGE)
        if excess(low) >= 0.0 or excess(high) <= 0.0:
            return None
        return math.exp(brentq(excess, low, high, xtol=1e-4))

    def _response(self, value: np.ndarray) -> Response:
        ones = np.ones(len(value))
        return Response(self._frequency, value, ones, ones, ones)


def designed(
        places: Sequence[LoopAtPlace], wanted: WantedLoop, near: Sequence[float]) -> Gains | None:
    """
    Return the gains whose margins are closest to the wanted one, of all that have the bandwidth.

    ``near`` are gains K_p at the places to begin the search at. None: no robust gains have this
    bandwidth at all places.
    """
    w = 2.0 * math.pi * wanted.bandwidth

    def cost(scaled: tuple[float, float]) -> float:
        """Return the cost of (K_f w, log of the corner over w)."""
        kf, log_corner = scaled
        if not (0.0 <= kf <= LARGEST_KF and CORNERS[0] <= math.exp(log_corner) <= CORNERS[-1]):
            return math.inf
        kps = _kps(places, wanted, near, math.exp(log_corner) * w, kf / w)
        if kps is None:
            return math.inf
        worst = max(abs(phase - wanted.phase_margin) for _, phase in kps) / TOLERATED_DEG
        return (max(worst, CLOSE) + KF_COST * kf
                + CORNER_COST * abs(log_corner - math.log(CORNERS[2])))
    grid = [(float(kf), math.log(corner)) for kf in KFS for corner in CORNERS]
    start = min(grid, key=cost)
    if not math.isfinite(cost(start)):
        return None
    best = minimize(cost, start, method='Nelder-Mead', options={
        'maxfev': 60, 'initial_simplex': [start, (start[0] + 0.1, start[1]),
                                          (start[0], start[1] + 0.2)]}).x
    corner, kf = math.exp(best[1]) * w, float(best[0]) / w
    kps = _kps(places, wanted, near, corner, kf)
    assert kps is not None      # the cost of the best is finite
    return _shared(places, wanted, Gains(kf, corner, np.array([kp for kp, _ in kps])))


def _kps(
        places: Sequence[LoopAtPlace], wanted: WantedLoop, near: Sequence[float], corner: float,
        kf: float) -> list[tuple[float, float]] | None:
    """Return K_p with the wanted bandwidth, and its margin, at each place; None: not robust."""
    found = []
    for place, start in zip(places, near, strict=True):
        kp = place.kp_for(wanted.bandwidth, corner, kf, start)
        predicted = None if kp is None else place.predicted(kp, corner, kf)
        if (kp is None or predicted is None or not predicted.is_robust
                or predicted.phase_margin is None):
            return None
        found.append((kp, predicted.phase_margin))
    return found


def _shared(places: Sequence[LoopAtPlace], wanted: WantedLoop, gains: Gains) -> Gains:
    """Return gains that share the error at each place between margin and bandwidth."""
    def error(place: LoopAtPlace, kp: float) -> float:
        predicted = place.predicted(kp, gains.corner, gains.kf)
        if predicted.phase_margin is None or predicted.bandwidth is None:
            return math.inf
        errors = [abs(share) for share in shares(
            wanted, predicted.phase_margin, predicted.bandwidth)]
        return math.hypot(*errors) + STEEP * max(0.0, max(errors) - 1.0)
    best = []
    for place, kp in zip(places, gains.kp, strict=True):
        errors = [error(place, nudge * kp) for nudge in NUDGES]
        best.append(kp * NUDGES[int(np.argmin(errors))])
    return replace(gains, kp=np.array(best))


def shares(wanted: WantedLoop, phase_margin: float, bandwidth: float) -> tuple[float, float]:
    """Return the errors of margin and bandwidth over what is tolerated."""
    return ((phase_margin - wanted.phase_margin) / TOLERATED_DEG,
            (bandwidth / wanted.bandwidth - 1.0) / TOLERATED_SHARE)
