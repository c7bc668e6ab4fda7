"""Forces on bodies in the axes of the world, the third of which points up."""

from collections.abc import Iterator

from isa_ros.analysis.signals.signals import Signals
from isa_ros.surroundings.messages import Force
import numpy as np
from numpy.typing import NDArray


def upward_forces(signals: Signals) -> Iterator[tuple[str, NDArray[np.float64]]]:
    """Yield the name of each force in the axes of the world, and its part upwards, N, (n,)."""
    for body in signals.run.bodies:
        forces = [message for message in body.messages(signals.run.step_ns)
                  if isinstance(message, Force) and not message.frame]
        for message in forces:
            field = message.force[2].partition('[')[0]
            if f'{body.name}.{field}' in signals:
                what = 'ground' if len(forces) == 1 else field
                yield f'{body.prefix}{what}', signals[f'{body.name}.{field}'][:, 2]
