"""An actuator under efforts that follow each other."""

from tests.sheets import setpoint

EFFORTS = (0.0, 50.0, -30.0, 80.0, 20.0, 60.0, -10.0, 40.0)  # N | Nm


def run(actuator, ticks):
    """Tick under changing efforts and return the samples' bytes."""
    samples = []
    for k in range(ticks):
        actuator.accept(setpoint(effort=EFFORTS[k % len(EFFORTS)]))
        actuator.tick()
        samples.append(actuator.sample.tobytes())
    return samples
