"""The plant alone, the plant with its REU, and a cylinder with a known solution."""

from functools import partial

from isa_ros.actuator import integration as kernels
from isa_ros.actuator.actuator import SmartActuator
from isa_ros.actuator.sheet import actuator_record
from isa_ros.analysis.accuracy import cylinder
from isa_ros.bench.row import Row, seconds
from isa_ros.config.runs.default_actuator import default_actuator, DEFAULT_TIMING
from isa_ros.core.signals import LOAD_PORT, SUPPLY_PORT
from isa_ros.core.timebase import NS_PER_SECOND, PLANT_STEP
import numpy as np

PLANT_STEPS = 20_000
ROOTS = 40               # square roots in a plant step
TICKS = 500
HOLDS = 10_000          # steps of the cylinder (constant input), ten seconds
HOLD_ROOTS = cylinder.STAGES * 4 * 2    # square roots in a hold: four orifices, two each


def plant_rows() -> list[Row]:
    """
    Measure plant alone and plant with REU on one core, compared with real time.

    The floor is the speed of the machine: the 40 square roots of a plant step (four evaluations,
    five orifices, two each), one after another.
    """
    roots = seconds(lambda: kernels.square_roots(PLANT_STEPS * ROOTS), PLANT_STEPS)
    rows = [Row(f'floor: {ROOTS} square roots', roots * 1e6, 'us', 'itself', 1.0)]
    for model in ('smart_manifold', 'isa_v5'):
        config = default_actuator(model, model)
        own = kernels.integrated(np.zeros(1, LOAD_PORT)[0], np.zeros(1, SUPPLY_PORT)[0],
                                 actuator_record(config.sheet, 0)[0])
        step = seconds(partial(kernels.rk4_steps, PLANT_STEPS, PLANT_STEP, 0.0, own), PLANT_STEPS)
        rows += [
            Row(f'{model}: plant, a step of 20 us', step * 1e6, 'us', 'real time',
                PLANT_STEP / step),
            Row(f'{model}: plant, the same', step * 1e6, 'us', 'square roots', roots / step)]
        actuator = SmartActuator(config, DEFAULT_TIMING)

        def ticks(actuator: SmartActuator = actuator) -> None:
            for _ in range(TICKS):
                actuator.tick()
        tick = seconds(ticks, TICKS)
        rows.append(Row(f'{model}: plant + REU, a tick of 1 ms', tick * 1e6, 'us',
                        'real time', DEFAULT_TIMING.step_ns / NS_PER_SECOND / tick))
    return rows


def cylinder_rows() -> list[Row]:
    """
    Measure the speed of the valve-driven cylinder in simulated s per CPU s, and its error.

    The error is the largest position error within ten seconds, relative to a solution with steps
    of a sixteenth; its ratio is that of the required nanometre to it.
    """
    roots = seconds(lambda: kernels.square_roots(HOLDS * HOLD_ROOTS), HOLDS, of_cpu=True)
    cylinders = cylinder.cylinder_record()
    states = cylinder.at_rest(HOLDS, cylinders[0])
    hold = seconds(
        lambda: cylinder.cylinder_run(1, cylinders, states), HOLDS, of_cpu=True)
    error = float(np.abs(states - cylinder.simulate(HOLDS, 16))[:, 0].max())
    return [
        Row(f'floor: {HOLD_ROOTS} square roots', roots * 1e6, 'us', 'itself', 1.0),
        Row('cylinder, order 8, a step of 1 ms', cylinder.HOLD / hold, 's/CPU s',
            'square roots', roots / hold),
        Row('cylinder: largest error', error, 'm', 'a nanometre', 1e-9 / error)]
