"""`isa bode` and `isa step`: measure a response, print, write and draw it."""

from argparse import Namespace
import json
from pathlib import Path
from typing import Any

from isa_ros.analysis.response import bode as bodes, step as steps, through_nodes
from isa_ros.analysis.response.figures import bode_figure, step_figure
from isa_ros.analysis.response.rig import Choice, Rig, rig
from isa_ros.analysis.response.sweep import Sweep
from isa_ros.errors import ConfigError
from matplotlib.figure import Figure
import numpy as np

BANDS = {'position': (0.5, 50.0), 'force': (1.0, 200.0), 'pressure': (1.0, 200.0),
         'spool': (2.0, 500.0), 'current': (10.0, 1500.0)}
"""Default bands, Hz; from well below the loop's bandwidth to well above it."""
DURATIONS = {'position': 1.0, 'force': 0.5, 'pressure': 0.5, 'spool': 0.05, 'current': 0.02}
_RESPONSES = {'closed': 'closed loop, output/reference', 'plant': 'plant, output/inward reference',
              'open': 'open loop, output/error'}


def bode(options: Namespace) -> None:
    """Measure a frequency response."""
    _refuse_figure(options.out)
    bench, band = _rig(options), BANDS[options.loop]
    sweep = Sweep(
        low=options.low or band[0], high=options.high or band[1], points=options.points,
        is_chirp=options.method == 'chirp')
    if options.nodes:
        measured = through_nodes.bode(
            bench, sweep, options.of, options.amplitude, options.bag)
    else:
        measured = bodes.bode(bench, sweep, options.of, options.amplitude)
    method = 'chirp' if sweep.is_chirp else 'stepped sine'
    title = (f'{_title(options, bench)}\n{measured.loop.label}: {_RESPONSES[options.of]}; '
             f'{method} of {_amplitude(measured)}')
    print(title)
    print(bodes.table(measured))
    if options.json is not None:
        _write(options.json, _setting(options, bench, measured) | _numbers(measured))
    if options.out is not None:
        _draw(bode_figure(measured, title), options.out)


def step(options: Namespace) -> None:
    """Measure a step response."""
    _refuse_figure(options.out)
    bench = _rig(options)
    duration = options.duration or DURATIONS[options.loop]
    if options.nodes:
        measured = through_nodes.step(bench, duration, options.amplitude, options.bag)
    else:
        measured = steps.step(bench, duration, options.amplitude)
    title = f'{_title(options, bench)}\n{measured.loop.label}: step of {_amplitude(measured)}'
    print(title)
    print(steps.summary(measured))
    if options.json is not None:
        found, scale = measured.figures, measured.loop.unit.scale
        _write(options.json, _setting(options, bench, measured) | {
            'rise_time_s': found.rise_time, 'overshoot': found.overshoot,
            'settling_time_s': found.settling_time, 'settling_band': steps.BAND,
            'steady_error': found.steady_error / scale, 'ripple': found.ripple / scale,
            't_s': measured.t.tolist(), 'reference': (measured.reference / scale).tolist(),
            'output': (measured.output / scale).tolist()})
    if options.out is not None:
        _draw(step_figure(measured, title), options.out)


def _title(options: Namespace, bench: Rig) -> str:
    return f'{bench.title}, through nodes' if options.nodes else bench.title


def _rig(options: Namespace) -> Rig:
    if options.bag is not None and not options.nodes:
        raise ConfigError(
            f'--bag {options.bag} is not used: without --nodes no bag is recorded')
    return rig(Choice(
        name=options.name, loop=options.loop, actuator=options.actuator, preset=options.preset,
        variants=options.variant, load=options.load, position=options.position))


def _amplitude(measured: bodes.Bode | steps.Step) -> str:
    unit = measured.loop.unit
    return f'{measured.amplitude / unit.scale:.4g} {unit.symbol}'


def _setting(
        options: Namespace, bench: Rig, measured: bodes.Bode | steps.Step) -> dict[str, Any]:
    config, unit = bench.config, measured.loop.unit
    return {
        'actuator': config.name, 'model': config.model, 'preset': config.preset,
        'through_nodes': options.nodes, 'load': bench.load,
        'loop': options.loop, 'unit': unit.symbol,
        'initial_position': config.initial_position,
        'amplitude': measured.amplitude / unit.scale}


def _numbers(measured: bodes.Bode) -> dict[str, Any]:
    response, margins = measured.response, measured.margins
    unit, into = measured.loop.response_unit(measured.of), bodes.input_unit(measured)
    columns = {
        'frequency_hz': response.frequency, 'gain': response.gain / unit.scale,
        'phase_deg': response.phase, 'coherence': response.coherence,
        'input_amplitude': response.input_amplitude / into.scale,
        'output_amplitude': response.output_amplitude / measured.loop.unit.scale}
    return {
        'of': measured.of, 'response_unit': unit.symbol, 'input_unit': into.symbol,
        **{name: np.asarray(column).tolist() for name, column in columns.items()},
        'bandwidth_hz': measured.bandwidth,
        'gain_margin_db': margins.gain_db, 'gain_margin_hz': margins.gain_frequency,
        'phase_margin_deg': margins.phase, 'phase_margin_hz': margins.phase_frequency}


def _refuse_figure(path: Path | None) -> None:
    """Refuse, before the measurement, a figure in an unknown format."""
    if path is None:
        return
    known = sorted(Figure().canvas.get_supported_filetypes())
    if path.suffix[1:] not in known:
        raise ConfigError(f'--out {path}: must end in one of .{", .".join(known)}')


def _write(path: Path, content: dict[str, Any]) -> None:
    path.write_text(json.dumps(content, indent=2) + '\n')
    print(path)


def _draw(figure: Figure, path: Path) -> None:
    figure.savefig(path)
    print(path)
