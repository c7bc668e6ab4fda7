"""Errors of a coupled run against the one ODE, in the measures of the accuracy limits."""

from dataclasses import dataclass, fields

import numpy as np
from tests.oracle.rig import Rig, ROW_NS, WINDOWS


@dataclass(frozen=True)
class Errors:
    """Relative errors, except for the angle; arrays are HAA, HFE, KFE."""

    rms: np.ndarray      # window-mean forces: RMS of the error over RMS of the reference
    peak: np.ndarray     # largest window-mean force
    ground: np.ndarray   # largest ground force at the ticks' ends, (1,); 0 without contact
    angle: np.ndarray    # largest departure of the joint angles, deg
    energy: np.ndarray   # work through the sensors at the end over its largest value

    def worst(self, other: 'Errors') -> 'Errors':
        """Return the larger of each."""
        return Errors(*[np.maximum(getattr(self, f.name), getattr(other, f.name))
                        for f in fields(self)])


def errors(coupled: np.ndarray, reference: np.ndarray, step_ns: int) -> Errors:
    """Return the `Errors` of a coupled `TRACE` at macro step ``step_ns``."""
    window = step_ns // WINDOWS // ROW_NS
    means = reference['mean'].reshape(-1, window, 3).mean(axis=1)
    ticks, at = coupled[WINDOWS - 1::WINDOWS], reference[step_ns // ROW_NS - 1::step_ns // ROW_NS]
    rms = np.sqrt(((coupled['mean'] - means) ** 2).mean(axis=0) / (means ** 2).mean(axis=0))
    peak = np.abs(np.abs(coupled['mean']).max(axis=0) / np.abs(means).max(axis=0) - 1.0)
    normal = at['normal'].max()
    ground = abs(ticks['normal'].max() / normal - 1.0) if normal > 0.0 else 0.0
    angle = np.degrees(np.abs(ticks['angle'] - at['angle']).max(axis=0))
    work = np.abs(ticks['work'][-1] - at['work'][-1]) / np.abs(at['work']).max(axis=0)
    return Errors(rms, peak, np.array([ground]), angle, work)


def compare(rig: Rig, commands: np.ndarray, duration_ns: int, release_ns: int,
            steps_ns: tuple[int, ...]) -> dict[int, Errors]:
    """Return the errors of one scenario at each macro step."""
    reference = rig.one_ode(commands, duration_ns, release_ns)
    return {step_ns: errors(rig.coupled(commands, duration_ns, release_ns, step_ns), reference,
                            step_ns) for step_ns in steps_ns}
