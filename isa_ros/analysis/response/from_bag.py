"""
The frequency response of a loop from a bag: of a scenario that sweeps the loop's reference.

Sensor readings and references are recorded at the end of each tick. A reference is held for a tick
and recorded at its end, so that a response from the reference includes the hold: its gain, and up
to half a tick of delay.
"""

import math
from pathlib import Path
from typing import NamedTuple

from isa_ros.analysis.response import bode as bodes
from isa_ros.analysis.response.actuator_trace import Trace
from isa_ros.analysis.response.at_rest import LoopAtRest, RECORDED_S, rest_of
from isa_ros.analysis.response.loops import loop_name, loop_of, PLANT
from isa_ros.analysis.response.rig import Rig
from isa_ros.analysis.response.sweep import chirp_band, Estimator, FrequencySweep, SEGMENT_CYCLES
from isa_ros.analysis.signals.frequency import SEGMENTS
from isa_ros.analysis.signals.signals import AT_EVERY_TICK, read_signals
from isa_ros.config.text.parameter_sets import kind_of
from isa_ros.core.timebase import NS_PER_SECOND
from isa_ros.errors import ConfigError
from isa_ros.loads.sheets import LocalLoad
import numpy as np


class RecordedLoop(NamedTuple):
    """One actuator of a bag with one of its loops."""

    rig: Rig
    trace: Trace
    """A row for the end of each tick."""
    excited: slice
    """The rows from the first change of the loop's reference to its last."""

    @property
    def rate(self) -> float:
        """Return the number of ticks per second."""
        return NS_PER_SECOND / self.rig.run.step_ns

    def lowest(self) -> float:
        """Return the lowest frequency that the excitation is long enough for, Hz."""
        ticks = int(self.excited.stop - self.excited.start) - SEGMENTS  # segments are rounded up
        return SEGMENT_CYCLES * SEGMENTS * self.rate / ticks


def recorded(bag: Path, actuator: str | None, wanted: str) -> RecordedLoop:
    """
    Return a loop of an actuator of a bag; without a name its only actuator.

    Raises
    ------
    BagError
        The bag cannot be read, or has no signals of the actuator.
    ConfigError
        The actuator or the loop does not exist, or the loop's reference does not change.

    """
    signals = read_signals(bag)
    names = [config.name for config in signals.run.actuators]
    if actuator is None and len(names) > 1:
        raise ConfigError(f'--bag {bag}: has {len(names)} actuators, --actuator names one of them')
    config = signals.run.actuator(actuator or names[0])
    loop = loop_of(config.sheet, loop_name(config, wanted))
    _refuse_unrecorded(f'{loop.name}_reference', bag)
    trace = {field: signals[f'{config.name}.{field}'] for field in AT_EVERY_TICK}
    reference = trace[f'{loop.name}_reference']
    changes = np.flatnonzero(np.diff(reference))
    if len(changes) < 2 or len(reference) != len(signals.time):
        raise ConfigError(
            f'--bag {bag}: {config.name}.{loop.name}_reference must change, and be recorded at '
            'every tick')
    load = 'its body' if config.load is None else kind_of(config.load, LocalLoad)
    return RecordedLoop(Rig(signals.run.alone(config), loop, load), trace,
                        slice(int(changes[0]), int(changes[-1]) + 2))


def bode(found: RecordedLoop, sweep: FrequencySweep, of: str, bag: Path) -> bodes.Bode:
    """
    Evaluate as `bode.bode`; the loop is at rest if its reference is, at the end of the bag.

    Raises
    ------
    AnalysisError
        The excitation is too short for the band, or does not have all of it.
    ConfigError
        The band is too high for the ticks, or the response is not recorded.

    """
    loop = found.rig.loop
    if of == PLANT and loop.inward is not None:
        _refuse_unrecorded(loop.inward, bag)
    sweep.check(found.rate, 'the bag has ticks')
    segment = chirp_band(sweep, found.rate, 1.0 / found.rate).segment
    excited = {name: values[found.excited] for name, values in found.trace.items()}
    amplitude = 0.5 * float(np.ptp(excited[f'{loop.name}_reference']))
    output, still = found.trace[loop.name], len(found.trace[loop.name]) - found.excited.stop
    return bodes.evaluate(
        loop, Estimator(found.rate, segment=segment, frequencies=sweep.frequencies), of, amplitude,
        excited, rest_of(output, amplitude, found.rate) if still >= RECORDED_S * found.rate
        else LoopAtRest(math.nan, math.nan, amplitude))


def _refuse_unrecorded(signal: str, bag: Path) -> None:
    if signal not in AT_EVERY_TICK:
        raise ConfigError(f'--bag {bag}: {signal.replace("_", " ")} is not recorded in bags')
