"""
Figures of the paper that show no signals over time: responses and characteristics.

Drawn from a run as `isa_ros.analysis.report.paper_figures`, each from the actuators that moved.
"""

from collections.abc import Callable, Mapping

from isa_ros.analysis.report.figures import stack
from isa_ros.analysis.signals.frequency import bandwidth, chirp_response, Response
from isa_ros.analysis.signals.signals import Signals
from isa_ros.config.runs.run_config import ActuatorConfig, RunConfig
from isa_ros.core.units import LPM, MILLI, MPA
from isa_ros.errors import ConfigError
from isa_ros.plant.plant import plant_record
from matplotlib.axes import Axes
from matplotlib.figure import Figure
import numpy as np

LAND_DROP = 3.5 * MPA       # at which figure 5 states its flows (erratum 2)
LEAST_DROP = 1.0 * MPA      # below it, a land's flow hardly depends on its opening
SEGMENT_S = 0.5             # of the chirp, whose spectra are averaged
SERIES = 'current, coils in series, mA'


def valve_response(signals: Signals) -> Figure:
    """Draw the response of each spool to its current, relative to K_spool, as Fig 4."""
    responses = {}
    for actuator in moved(signals):
        name, plant = actuator.name, plant_record(actuator.sheet.plant)[0]
        per_ampere = plant.valve.k_spool / plant.coil.parallel
        responses[name] = _chirp(
            signals[f'{name}.current_reference'], signals[f'{name}.current'] * per_ampere,
            signals[f'{name}.spool'], signals.run)
    return _bode('Response of the valves, as Fig 4', 'spool over current', responses)


def force_response(signals: Signals) -> Figure:
    """Draw the response of each force or torque to its reference."""
    responses = {}
    for actuator in moved(signals):
        reference = signals[f'{actuator.name}.force_reference']
        force = signals[f'{actuator.name}.force']
        responses[actuator.name] = _chirp(reference, reference, force, signals.run)
    rotary = {actuator.sheet.is_rotary for actuator in moved(signals)}
    output = ' and '.join(word for word, is_rotary in (('force', False), ('torque', True))
                          if is_rotary in rotary)
    return _bode(f'Bandwidth of the {output}', f'{output} over reference', responses)


def flow_gain(signals: Signals) -> Figure:
    """Draw the flow of the open land from the supply, at 3.5 MPa, over the current, as Fig 5."""
    figure, (ax,) = _axes(1, 'Flow gain of the valves, as Fig 5')
    for actuator in moved(signals):
        name, plant = actuator.name, plant_record(actuator.sheet.plant)[0].valve
        spool, supply = signals[f'{name}.spool'], signals.supply_pressure(name).values
        drop = supply - np.where(
            spool > 0.0, signals[f'{name}.pressure_a'], signals[f'{name}.pressure_b'])
        tare = plant.c_tare * np.sqrt(supply)
        flow = signals[f'{name}.supply_flow'] - tare
        flow = flow * np.sqrt(LAND_DROP / np.maximum(drop, LEAST_DROP))
        used = drop > LEAST_DROP
        ax.plot(spool[used] / plant.k_spool / MILLI, np.sign(spool[used]) * flow[used] / LPM, '.',
                markersize=2, label=f'{name} ({actuator.model})')
    ax.set_ylabel('flow of one land at 3.5 MPa, l/min')
    return _finish(figure, (ax,), SERIES)


def leakage(signals: Signals) -> Figure:
    """Draw the supply flow of each blocked actuator over its current, as Fig 6."""
    figure, (ax,) = _axes(1, 'Leakage of the valves, as Fig 6')
    for actuator in moved(signals):
        name, plant = actuator.name, plant_record(actuator.sheet.plant)[0].valve
        after = slice(1, None)  # at t = 0 nothing has flowed yet
        ax.plot(signals[f'{name}.spool'][after] / plant.k_spool / MILLI,
                signals[f'{name}.supply_flow'][after] / LPM, linewidth=1.0,
                label=f'{name} ({actuator.model})')
    ax.set_ylabel('supply flow, l/min')
    ax.set_ylim(bottom=0.0)
    return _finish(figure, (ax,), SERIES)


def current_step(signals: Signals) -> Figure:
    """Draw reference and current of the amplifiers over time, as Fig 8."""
    actuators = moved(signals)
    figure, axes = _axes(len(actuators), 'Steps of the current, as Fig 8')
    for ax, actuator in zip(axes, actuators):
        t, current = signals.over_time(f'{actuator.name}.current')
        reference = signals[f'{actuator.name}.current_reference']
        ax.plot(t, reference / MILLI, color='blue', linestyle='--', label='reference')
        ax.plot(t, current / MILLI, color='red', label='current')
        ax.set_ylabel(f'{actuator.name}, mA')
    return _finish(figure, axes, 'simulation time, s')


RESPONSES: Mapping[str, Callable[[Signals], Figure]] = {
    'valve_response': valve_response, 'flow_gain': flow_gain, 'leakage': leakage,
    'current_step': current_step, 'bandwidth': force_response}


def moved(signals: Signals) -> list[ActuatorConfig]:
    """
    Return the actuators whose references moved.

    Raises
    ------
    ConfigError
        No reference moved, so there is nothing to draw.

    """
    found = []
    for actuator in signals.run.actuators:
        if any(np.ptp(signals[f'{actuator.name}.{name}_reference']) > 0.0
               for name in ('force', 'current')):
            found.append(actuator)
    if not found:
        raise ConfigError(
            f'{signals.run.source}: no reference moves, so there is no response to draw')
    return found


def _chirp(r: np.ndarray, x: np.ndarray, y: np.ndarray, run: RunConfig) -> Response:
    rate = 1e9 / run.step_ns
    highest = min(400.0, 0.18 * rate)
    return chirp_response(np.geomspace(5.0, highest, 60), SEGMENT_S, r, x, y, rate)


def _bode(title: str, ratio: str, responses: Mapping[str, Response]) -> Figure:
    figure, (gain, phase) = _axes(2, title)
    for name, response in responses.items():
        width = bandwidth(response, 1.0)
        label = name if width is None else f'{name}, -3 dB at {width:.3g} Hz'
        gain.semilogx(response.frequency, response.gain_db, label=label)
        phase.semilogx(response.frequency, response.phase, label=name)
    gain.axhline(-3.0, color='gray', linewidth=0.8, linestyle=':')
    gain.set_ylabel(f'{ratio}, dB')
    phase.set_ylabel('phase, deg')
    return _finish(figure, (gain, phase), 'frequency, Hz')


def _axes(rows: int, title: str) -> tuple[Figure, tuple[Axes, ...]]:
    return stack(rows, title, 2.6 * rows + 1.2)


def _finish(figure: Figure, axes: tuple[Axes, ...], x_label: str) -> Figure:
    for ax in axes:
        ax.grid(visible=True, linewidth=0.4)
        ax.legend(fontsize='small')
    axes[-1].set_xlabel(x_label)
    return figure
