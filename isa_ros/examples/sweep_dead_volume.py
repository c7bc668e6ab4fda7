"""
What dead volume does to the landing of the leg: `python -m isa_ros.examples.sweep_dead_volume`.

The drop of 10 cm, simulated with several dead volumes of the knee and both heights, on all cores.
"""

import isa_ros
import numpy as np

DEAD_VOLUME = 'actuators.kfe.parameters.plant.oil.dead_volume_ml'
HEIGHT = 'scenario.leg.foot_height_mm'


def peak(result: isa_ros.Result) -> float:
    """Return the largest force of the knee, N."""
    return float(np.abs(result['kfe.force']).max())


def ripple(result: isa_ros.Result) -> float:
    """Return half of the peak to peak pressure of chamber A in the last 0.2 s, Pa."""
    at_rest = result.time >= result.time[-1] - 0.2
    return 0.5 * float(np.ptp(result['kfe.pressure_a'][at_rest]))


def table(workers: int = -1) -> isa_ros.Sweep:
    """Return a row for each combination."""
    return isa_ros.sweep(
        isa_ros.load('leg', 'drop'), {HEIGHT: [50.0, 100.0], DEAD_VOLUME: [2.0, 2.5, 4.0]},
        measure={'peak, N': peak, 'ripple, Pa': ripple}, workers=workers, progress=True)


if __name__ == '__main__':
    print(table())
