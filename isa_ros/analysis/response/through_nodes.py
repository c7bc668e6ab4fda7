"""
The measurements of `bode` and `step` through running nodes: a scenario, its bag, the estimators.

All signals are recorded at the ticks: the sensor readings and the references in force at the end
of each. A reference is held for a tick and recorded at its end, so that a response from the
reference includes the hold: its gain, and up to half a tick of delay.
"""

from contextlib import ExitStack
import math
from pathlib import Path
import sys
from tempfile import TemporaryDirectory

from isa_ros.analysis.response import bode as bodes, step as steps
from isa_ros.analysis.response.actuator_trace import Trace
from isa_ros.analysis.response.at_rest import rest_of, ticks_at_rest
from isa_ros.analysis.response.loops import Loop, PLANT
from isa_ros.analysis.response.rig import REST_S, Rig
from isa_ros.analysis.response.sweep import Answer, chirp_band, sections, Sweep, windows
from isa_ros.analysis.signals.signals import AT_EVERY_TICK, read_signals
from isa_ros.config.runs.run_config import RunConfig
from isa_ros.config.text.parameter_sets import as_tree
from isa_ros.config.text.yaml_text import dump, Tree
from isa_ros.core.timebase import NS_PER_SECOND
from isa_ros.core.units import MILLI
from isa_ros.errors import ConfigError
from isa_ros.loads.sheets import LocalLoad
from isa_ros.run.options import Request
from isa_ros.run.session import prepare
from isa_ros.run.terminal import terminal_report
from isa_ros.surroundings.supply import SupplySheet
import numpy as np

RECORDED = ('position_reference', 'force_reference', 'spool_reference', 'current_reference')
UNRECORDED = ('pressure_reference', 'drive')
"""The references that nodes record, and those that they do not."""


def bode(
        rig: Rig, sweep: Sweep, of: str, amplitude: float | None, bag: Path | None
        ) -> bodes.Bode:
    """
    Measure as `bode.bode`, through nodes; ``bag`` is the directory of the bag, None: not kept.

    Raises
    ------
    ConfigError
        The band, the amplitude or the loop cannot be measured.
    BagError, RunError, SimulationDiverged
        The run cannot be recorded or completed.

    """
    _refuse_unrecorded(rig.loop, of)
    rate = NS_PER_SECOND / rig.run.step_ns
    if rate < rig.loop.rate_hz:
        sweep.check(rate, 'the nodes take setpoints')
    else:
        sweep.check(rig.loop.rate_hz, f'the {rig.loop.name} loop takes its reference')
    peak = rig.amplitude(amplitude)
    points, end, answer = _excited(rig, sweep, peak, rate)
    n_push, n_still = ticks_at_rest(rate)
    points += [_point(rig, end, {}, peak), _point(rig, end + n_push, {})]
    first = _rest(rig) + 1
    trace = _recorded(rig, points, end + n_push + n_still, bag, first)
    excited = {name: values[:end + 1 - first] for name, values in trace.items()}
    return bodes.evaluate(
        rig.loop, answer, of, peak, excited, rest_of(trace[rig.loop.name], peak, rate))


def step(rig: Rig, duration: float, amplitude: float | None, bag: Path | None) -> steps.Step:
    """Measure as `step.step`, through nodes; ``bag`` and errors as in `bode`."""
    _refuse_unrecorded(rig.loop, '')
    steps.check_duration(duration)
    peak, tick = rig.amplitude(amplitude), rig.run.step_ns / NS_PER_SECOND
    before, after = _rest(rig), math.ceil(duration / tick)
    points = [_point(rig, 0, {}), _point(rig, before, {}, peak)]
    # Row k has the setpoint of tick k - 1: the step is in the row after its tick.
    shown = round(steps.BEFORE * after)
    trace = _recorded(rig, points, before + after, bag, first=before - shown)
    return steps.evaluate(rig.loop, trace, shown, rig.offset, peak, 1.0 / tick)


def _refuse_unrecorded(loop: Loop, of: str) -> None:
    for signal in (f'{loop.name}_reference', *([loop.inward] if of == PLANT else [])):
        if signal is not None and signal not in RECORDED:
            raise ConfigError(
                f'--nodes: {str(signal).replace("_", " ")} is not recorded by the nodes; measure '
                'without --nodes')


def _rest(rig: Rig) -> int:
    """Return the number of ticks at rest before the excitation."""
    return math.ceil(REST_S * NS_PER_SECOND / rig.run.step_ns)


def _point(rig: Rig, tick: int, motion: Tree, value: float = 0.0) -> Tree:
    """Return a scenario's setpoint: the loop's reference at ``value`` (SI) from its rest."""
    given = rig.loop.per_reference * value
    is_position = rig.loop.quantity == 'position'
    return {
        't_s': tick * rig.run.step_ns / NS_PER_SECOND,
        'position': rig.config.initial_position + (given if is_position else 0.0),
        'effort': 0.0 if is_position else given, **motion}


def _excited(
        rig: Rig, sweep: Sweep, peak: float, rate: float) -> tuple[list[Tree], int, Answer]:
    """Return the setpoints of a sweep, its last tick, and the estimator of the response."""
    loop, rest = rig.loop, _rest(rig)
    common: Tree = {'moves': loop.quantity, 'amplitude': loop.per_reference * peak}
    points = [_point(rig, 0, {})]
    if sweep.is_chirp:
        band = chirp_band(sweep, rate, 1.0 / rate)
        motion: Tree = common | {
            'start_hz': band.low, 'end_hz': band.high, 'duration_s': band.duration,
            'sweep': 'exponential'}
        points.append(_point(rig, rest, {'chirp': motion}))
        return points, rest + round(band.duration * rate), Answer(
            rate, segment=band.segment, frequencies=sweep.frequencies)
    parts, tick = sections(sweep, 1.0 / rate), rest
    for frequency, settle, measured in parts:
        sine: Tree = common | {'frequency_hz': frequency}
        points.append(_point(rig, tick, {'sine': sine}))
        tick += round(settle * rate) + round(measured * rate)
    return points, tick, Answer(rate, windows(parts, rate, 0))


def _recorded(rig: Rig, points: list[Tree], end: int, bag: Path | None, first: int) -> Trace:
    """
    Run a rig's actuator in processes; return the recorded part of its trace, else NaN.

    It has a row for the end of each tick from ``first`` on; row 0 would be t = 0.
    """
    name = rig.config.name
    with ExitStack() as stack:
        files = Path(stack.enter_context(TemporaryDirectory(prefix='isa_')))
        config, scenario = files / f'{rig.run.name}.yaml', files / 'excitation.yaml'
        config.write_text(run_file(rig.run))
        scenario.write_text(dump({
            'name': 'excitation', 'duration_s': end * rig.run.step_ns / NS_PER_SECOND,
            'tracks': {name: points}}))
        out = files / 'bag' if bag is None else bag
        from isa_ros.nodes.bringup import run_session  # imports rclpy, which only this needs
        run_session(
            prepare(Request(config=config, scenario=scenario, out=out)),
            terminal_report(sys.stderr))
        signals = read_signals(out)
        unknown = np.full(len(signals.time) - first, math.nan)
        return dict.fromkeys(UNRECORDED, unknown) | {
            field: signals[f'{name}.{field}'][first:] for field in AT_EVERY_TICK}


def run_file(run: RunConfig) -> str:
    """Return a run of actuators with their own loads as the text of a complete run file."""
    actuators: dict[str, Tree] = {}
    for config in run.actuators:
        key, scale = (('initial_position_deg', math.radians(1.0)) if config.sheet.is_rotary
                      else ('initial_position_mm', MILLI))
        actuators[config.name] = {
            'model': config.model, 'preset': config.preset.partition(' ')[0],
            'parameters': as_tree(config.sheet), key: config.initial_position / scale}
        if config.load is not None:
            actuators[config.name]['load'] = as_tree(config.load, LocalLoad)
    return dump({
        'name': run.name, 'step_ms': run.step_ns * 1e-6,
        'controller_offset_ms': run.controller_offset_ns * 1e-6,
        'tick_timeout_s': run.tick_timeout_s,
        'supply': as_tree(run.supplies[0].sheet, SupplySheet),
        'actuators': dict(actuators)})
