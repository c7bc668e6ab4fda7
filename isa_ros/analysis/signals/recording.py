"""One actuator's sensor signals from a bag, as arrays on one grid of time."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from isa_ros.analysis.signals.signals import Signals
from isa_ros.config.runs.run_config import ActuatorConfig
from isa_ros.core.frozen import frozen
from isa_ros.core.units import MPA
from isa_ros.errors import BagError
from isa_ros.plant.plant import plant_record
import numpy as np

SHORTEST = 0.5          # s, below which the scatter cannot be estimated
SLOWEST_STEP = 2e-3    # s, with which a valve of 100 Hz can just be followed
_JITTER = 1e-6          # s, of a sample against the grid
_SIGNALS = ('position', 'force', 'pressure_a', 'pressure_b', 'spool')
_SUPPLY = 'supply_pressure'


@frozen
class Recording:
    """
    The sensor signals, each (n,), SI and gauge, ``step`` seconds apart.

    ``plant`` is the `PLANT` record of the configuration, with known and compared parameters.
    """

    plant: np.record
    step: float
    position: np.ndarray
    force: np.ndarray
    pressure_a: np.ndarray
    pressure_b: np.ndarray
    spool: np.ndarray
    supply_pressure: np.ndarray
    return_pressure: float

    @property
    def duration(self) -> float:
        """Return the time from the first sample to the last, s."""
        return (len(self.position) - 1) * self.step

    def half_rate(self) -> 'Recording':
        """Return the recording without every second sample."""
        return replace(self, step=2.0 * self.step, **{
            name: getattr(self, name)[::2] for name in (*_SIGNALS, _SUPPLY)})

    def is_trapped(self, margin: float) -> np.ndarray:
        """Return where neither relief nor refill passes oil, by ``margin`` (Pa), (n,)."""
        least = self.return_pressure + margin
        sensors = self.plant.sensors
        most = min(self.plant.relief.p_open, sensors.pressure_range) - margin
        is_trapped: np.ndarray = np.ones(len(self.position), bool)
        for pressure in (self.pressure_a, self.pressure_b):
            is_trapped &= (pressure > least) & (pressure < most)
        return is_trapped

    def is_standing(self, ends: np.ndarray, signals: Sequence[str]) -> np.ndarray:
        """
        Return for each window between ``ends`` whether no signal changes by more than a code.

        The rounding of a constant code does not average out.
        """
        is_standing: np.ndarray = np.ones(len(ends) - 1, bool)
        for name in signals:
            signal, step = getattr(self, name), self.resolution(name)
            spread = np.maximum.reduceat(signal, ends[:-1]) - np.minimum.reduceat(
                signal, ends[:-1])
            is_standing &= spread < 1.5 * step
        return is_standing

    def resolution(self, name: str) -> float:
        """Return the least step of a signal, SI."""
        own = self.plant.sensors
        return float({
            'position': own.encoder, 'force': own.force_step, 'spool': own.spool_step,
            'pressure_a': own.pressure_step, 'pressure_b': own.pressure_step}[name])

    def is_whole(self, ends: np.ndarray, condition: np.ndarray) -> np.ndarray:
        """Return for each window between ``ends`` whether the condition holds throughout."""
        broken = np.concatenate([[0], np.cumsum(~condition)])
        is_whole: np.ndarray = broken[ends[1:] + 1] == broken[ends[:-1]]
        return is_whole


def recording_of(signals: Signals, actuator: ActuatorConfig, bag: Path) -> Recording:
    """
    Return one actuator's recording.

    Raises
    ------
    BagError
        A signal is missing, or the signals are not sampled together.

    """
    t, found = None, {}
    for name in (*_SIGNALS, _SUPPLY):
        signal = (signals.supply_pressure(actuator.name) if name == _SUPPLY
                  else signals.over_time(f'{actuator.name}.{name}'))
        t = signal.t if t is None else t
        if len(signal.t) != len(t) or np.max(np.abs(signal.t - t)) > _JITTER:
            raise BagError(f'{bag}: {name} is not sampled together with the others')
        found[name] = signal.values
    assert t is not None
    return Recording(
        plant=plant_record(actuator.sheet.plant)[0], step=_grid(t, bag),
        return_pressure=signals.run.supply_of(actuator.name).return_pressure_mpa * MPA, **found)


def _grid(t: np.ndarray, bag: Path) -> float:
    """Return the step of evenly spaced samples, s."""
    if len(t) < 2:
        raise BagError(f'{bag}: has {len(t)} samples, must have more')
    step = float(t[-1] - t[0]) / (len(t) - 1)
    worst = float(np.max(np.abs(np.diff(t) - step)))
    if worst > _JITTER:
        raise BagError(
            f'{bag}: samples are missing, a step of {1e3 * (step + worst):g} ms among '
            f'steps of {1e3 * step:g} ms')
    if step > SLOWEST_STEP + _JITTER:
        raise BagError(f'{bag}: sampled every {1e3 * step:g} ms, must be at least every '
                       f'{1e3 * SLOWEST_STEP:g} ms')
    return step
