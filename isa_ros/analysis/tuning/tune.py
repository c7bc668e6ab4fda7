"""
`isa tune`: gains of the force block for a wanted phase margin and bandwidth over the stroke.

Each round measures the closed loop at every place as `isa bode` does, takes the plant from it,
and designs gains for that plant. The plant of a valve depends on the amplitude, and the amplitude
in the valve on the gains, so that the rounds are repeated until the measured loops are as wanted.
"""

from collections.abc import Sequence
from dataclasses import replace
import math

from isa_ros.analysis.response.bode import Bode, bode
from isa_ros.analysis.response.rig import Rig
from isa_ros.analysis.response.sweep import FrequencySweep, LARGEST_SHARE
from isa_ros.analysis.tuning.block_response import parts, responses
from isa_ros.analysis.tuning.design import (
    DENSE, designed, Gains, LoopAtPlace, plant_of, shares, WantedLoop)
from isa_ros.core.frozen import frozen
from isa_ros.core.parameter import replaced
from isa_ros.errors import ConfigError, IsaError
from isa_ros.plant.load_holding import NoneHolding
from isa_ros.reu.block import Pid
from isa_ros.reu.schedule import FivePoints
from isa_ros.text.progress import Progress
import numpy as np

STROKES = (0.05, 0.25, 0.5, 0.75, 0.95)
NODES = np.linspace(0.0, 1.0, 5)    # of the gain schedule
SPAN = 8.0          # highest frequency over the wanted bandwidth, and that over the lowest one
POINTS = 22
ROUNDS = 6
ENOUGH = 0.6        # of the tolerances, at which no further round is made
BETTER = 0.9        # of the error before: a smaller improvement ends the rounds
LOWER = 0.8         # a bandwidth that cannot be had is lowered by this factor
STARTS = 8          # gains tried until a loop follows and does not hunt
QUIETER, LOUDER = 1.0 / 3.0, 3.0
FOLLOWS = 0.05      # least gain of the closed loop at the lowest frequency
TRUSTED = POINTS // 2   # least number of coherent points
DIGITS = 4          # of the gains in the file
STRAIGHT = 1e-3     # weight of a bend of the schedule against that of a value


class NotReached(IsaError):
    """No gains with which the loop could be measured."""

    exit_code = 1


@frozen
class Reached:
    """The measured loop at one place of the stroke."""

    share: float            # of the stroke
    rig: Rig
    measured: Bode
    wanted: WantedLoop

    @property
    def error(self) -> float:
        """Return the larger error of margin and bandwidth over its tolerance; inf if it hunts."""
        found, band = self.measured.margins.phase, self.measured.bandwidth
        if self.measured.rest.hunts or found is None or band is None:
            return math.inf
        return max(map(abs, shares(self.wanted, found, band)))


@frozen
class Tuned:
    """The gains that were found, and the loops measured with them."""

    block: Pid
    reached: tuple[Reached, ...]

    @property
    def error(self) -> float:
        """Return the largest error over its tolerance."""
        return max(place.error for place in self.reached)

    @property
    def hunts(self) -> bool:
        """Return whether the loop hunts at one of the places."""
        return any(place.measured.rest.hunts for place in self.reached)

    @property
    def is_reached(self) -> bool:
        """Return whether every place is quiet and within the tolerances of `shares`."""
        return self.error <= 1.0


def tune(
        rig: Rig, wanted: WantedLoop, strokes: Sequence[float] = STROKES,
        amplitude: float | None = None, progress: Progress | None = None) -> Tuned:
    """
    Return the gains of a rig's force block for a wanted margin and bandwidth at ``strokes``.

    If they cannot be had, the closest that were measured; ``amplitude`` is in the loop's unit.

    Raises
    ------
    ConfigError
        The block is not a PID, or the bandwidth is beyond its rate.
    NotReached
        No gains are found with which the loop follows its reference and does not hunt.
    SimulationDiverged
        A state is no longer finite.

    """
    block = rig.config.sheet.reu.force
    if not isinstance(block, Pid):
        raise ConfigError(f'{rig.config.name}: reu.force.kind must be pid to be tuned')
    highest = LARGEST_SHARE * block.rate_hz / 2.0
    if wanted.bandwidth >= highest:
        raise ConfigError(
            f'--bandwidth = {wanted.bandwidth:g} Hz, must be < {highest:g} Hz: the force loop '
            f'runs at {block.rate_hz:g} Hz')
    bench = _Bench(rig, wanted, tuple(strokes), amplitude, progress)
    even = FivePoints(
        retracted=1.0, first_quarter=1.0, middle=1.0, last_quarter=1.0, extended=1.0)
    best = quiet = bench.start(replace(block, gain_schedule=even))
    aim = wanted
    for _ in range(ROUNDS):
        gains, aim = bench.design(quiet, aim)
        current = bench.measured(with_gains(block, gains, strokes))
        if current.hunts:   # nothing can be designed from its response
            aim = replace(aim, bandwidth=LOWER * aim.bandwidth)
            continue
        quiet, gained = current, current.error < BETTER * best.error
        best = min(best, current, key=lambda tuned: tuned.error)
        if best.error <= ENOUGH or (best.is_reached and not gained):
            break
    return best


class _Bench:
    """Measures a block at all places, and designs another one from that."""

    def __init__(
            self, rig: Rig, wanted: WantedLoop, strokes: tuple[float, ...],
            amplitude: float | None, progress: Progress | None) -> None:
        self._rig, self._wanted, self._strokes = rig, wanted, strokes
        self._amplitude, self._progress = amplitude, progress
        self._done, self._total = 0, (ROUNDS + 1) * len(strokes)
        high = min(SPAN * wanted.bandwidth, LARGEST_SHARE * rig.loop.rate_hz)
        self._sweep = FrequencySweep(low=wanted.bandwidth / SPAN, high=high, points=POINTS)

    def measured(self, block: Pid) -> Tuned:
        """Return the loops with a block at every place."""
        return Tuned(block, tuple(self._at(block, share) for share in self._strokes))

    def _at(self, block: Pid, share: float) -> Reached:
        rig = with_block(self._rig, block, share)
        found = Reached(
            share, rig, bode(rig, self._sweep, 'closed', self._amplitude), self._wanted)
        self._done = min(self._done + 1, self._total)
        if self._progress is not None:
            self._progress(self._done, self._total)
        return found

    def start(self, block: Pid) -> Tuned:
        """Return the loops with the block's own gains, or with the first that can be measured."""
        for _ in range(STARTS):
            found = self.measured(block)
            responses_there = [place.measured.response for place in found.reached]
            if found.hunts:
                factor = QUIETER
            elif (min(response.gain[0] for response in responses_there) < FOLLOWS
                    or min(response.is_trusted.sum() for response in responses_there) < TRUSTED):
                factor = LOUDER
            else:
                return found
            block = replace(block, kp=factor * block.kp, ki=factor * block.ki)
        raise NotReached(
            f'{self._rig.config.name}: not reached: no gains around those of the preset '
            f'(reu.force.kp = {block.kp:.3g} at last) follow the reference without hunting'
            + held(self._rig))

    def design(self, current: Tuned, wanted: WantedLoop) -> tuple[Gains, WantedLoop]:
        """Return gains and what they are for: as wanted, or the next bandwidth that exists."""
        sheet = current.block
        frequency = np.geomspace(self._sweep.low, self._sweep.high, DENSE)
        block_parts = parts(sheet, frequency)
        places, near = [], []
        for at in current.reached:
            closed = at.measured.response
            factor = float(np.interp(at.share, NODES, factors(sheet)))
            plant = plant_of(closed, *responses(sheet, closed.frequency, factor))
            places.append(LoopAtPlace(plant, *block_parts, frequency))
            near.append(factor * sheet.kp)
        while wanted.bandwidth > 2.0 * self._sweep.low:
            gains = designed(places, wanted, near)
            if gains is not None:
                return gains, wanted
            wanted = replace(wanted, bandwidth=LOWER * wanted.bandwidth)
        raise NotReached(
            f'{self._rig.config.name}: not reached: no gains with a bandwidth of '
            f'{wanted.bandwidth:.3g} to {self._wanted.bandwidth:.3g} Hz leave a gain margin')


def held(rig: Rig) -> str:
    """Return what to do behind a load-holding valve, which opens and shuts with the force."""
    found = [name for name in ('holding_a', 'holding_b')
             if not isinstance(getattr(rig.config.sheet.plant, name), NoneHolding)]
    return '; its poppet opens and shuts: tune with ' + ' '.join(
        f'--set plant.{name}.stuck_open=1' for name in found) if found else ''


def with_block(rig: Rig, block: Pid, share: float) -> Rig:
    """Return a rig with another force block, at a share of the stroke."""
    sheet = replaced(rig.config.sheet, 'reu.force', block)
    return replace(rig, loop=replace(rig.loop, sheet=sheet)).with_config(replace(
        rig.config, sheet=sheet, initial_position=share * sheet.plant.drive.stroke))


def factors(block: Pid) -> list[float]:
    """Return the five factors of a tuned block's schedule, retracted first."""
    schedule = block.gain_schedule
    assert isinstance(schedule, FivePoints)
    return [schedule.retracted, schedule.first_quarter, schedule.middle, schedule.last_quarter,
            schedule.extended]


def with_gains(block: Pid, gains: Gains, strokes: Sequence[float]) -> Pid:
    """
    Return a block with gains at mid stroke, and the schedule that gives those at ``strokes``.

    Both are rounded to `DIGITS` digits, as they are written.
    """
    kps = schedule_through(strokes, gains.kp)
    middle = float(kps[2])
    first, second, _, fourth, last = (_rounded(float(kp) / middle) for kp in kps)
    return replace(
        block, kp=_rounded(middle), ki=_rounded(gains.corner * middle), kf=_rounded(gains.kf),
        gain_schedule=FivePoints(
            retracted=first, first_quarter=second, middle=1.0, last_quarter=fourth,
            extended=last))


def schedule_through(strokes: Sequence[float], values: np.ndarray) -> np.ndarray:
    """
    Return the values at `NODES` whose straight lines pass closest to ``values`` at ``strokes``.

    Where the strokes leave a node open, the lines are as straight as possible. No node has less
    than half of the smallest value, or more than twice the largest one.
    """
    weights = np.array([np.interp(strokes, NODES, row) for row in np.eye(len(NODES))]).T
    straight = np.diff(np.eye(len(NODES)), 2, axis=0) * STRAIGHT
    found = np.linalg.lstsq(
        np.vstack((weights, straight)),
        np.concatenate((values, np.zeros(len(straight)))), rcond=None)[0]
    clipped: np.ndarray = np.clip(found, 0.5 * values.min(), 2.0 * values.max())
    return clipped


def _rounded(value: float) -> float:
    return float(f'{value:.{DIGITS}g}')
