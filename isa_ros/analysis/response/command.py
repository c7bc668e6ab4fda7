"""`isa bode` and `isa step`: measure a response, print, write and draw it."""

from argparse import Namespace
from collections.abc import Callable, Sequence
from typing import Any, TYPE_CHECKING

from isa_ros.analysis.figure_file import refuse_figure
from isa_ros.analysis.response import bode as bodes, from_bag, step as steps
from isa_ros.analysis.response.rig import Rig
from isa_ros.analysis.response.series import Member, members, refuse_beside_a_bag
from isa_ros.analysis.response.sweep import FrequencySweep, LARGEST_SHARE
from isa_ros.errors import ConfigError
from isa_ros.text.json_file import write_wanted
import numpy as np

if TYPE_CHECKING:   # without a figure Matplotlib is never loaded
    from matplotlib.figure import Figure

BANDS = {'position': (0.5, 50.0), 'force': (1.0, 200.0), 'pressure': (1.0, 200.0),
         'spool': (2.0, 500.0), 'current': (10.0, 1500.0)}
"""Default bands, Hz; from well below the loop's bandwidth to well above it."""
DURATIONS = {'position': 1.0, 'force': 0.5, 'pressure': 0.5, 'spool': 0.05, 'current': 0.02}
_RESPONSES = {'closed': 'closed loop, output/reference', 'plant': 'plant, output/inward reference',
              'open': 'open loop, output/error'}


def bode(options: Namespace) -> bool:
    """Measure frequency responses; return whether all are results: none of the loops hunts."""
    refuse_figure(options.out)
    if options.bag is None:
        recorded, benches = None, members(options)
        low, high = BANDS[benches[0].rig.loop.name]
    else:
        refuse_beside_a_bag(options)
        recorded = from_bag.recorded(options.bag, options.actuator, options.loop)
        benches = [Member('', recorded.rig)]
        low, high = BANDS[recorded.rig.loop.name]
        low, high = max(low, recorded.lowest()), min(high, LARGEST_SHARE * recorded.rate)
    _refuse_units(options, benches)
    sweep = FrequencySweep(
        low=options.low or low, high=options.high or high, points=options.points,
        is_chirp=options.method == 'chirp')
    method = (f'as in {options.bag},' if recorded else 'chirp' if sweep.is_chirp
              else 'stepped sine')
    title, found = '', []
    responses: list[bodes.Bode] = []
    for label, bench in benches:
        measured = (
            from_bag.bode(recorded, sweep, options.of, options.bag) if recorded
            else bodes.bode(bench, sweep, options.of, options.amplitude))
        title = (f'{bench.title}\n{measured.loop.label}: {_RESPONSES[options.of]}; '
                 f'{method} of {_amplitude(measured)}')
        _print(title, bodes.table(measured), is_first=not responses)
        responses.append(measured)
        found.append(_setting(options, bench, measured, label) | _numbers(measured))

    def figure() -> 'Figure':
        from isa_ros.analysis.response.figures import bode_figure
        return bode_figure(responses, [label for label, _ in benches], title if len(benches) == 1
                           else f'{options.loop}: {_RESPONSES[options.of]}; {method}')
    _write(options, found, figure)
    return not any(measured.rest.hunts for measured in responses)


def step(options: Namespace) -> bool:
    """Measure step responses; False: an output swings on, as that of a loop that hunts."""
    refuse_figure(options.out)
    benches = members(options)
    duration = options.duration or DURATIONS[benches[0].rig.loop.name]
    title, found = '', []
    responses: list[steps.StepResponse] = []
    for label, bench in benches:
        measured = steps.step(bench, duration, options.amplitude)
        title = (f'{bench.title}\n{measured.loop.label}: step of '
                 f'{_amplitude(measured)}')
        _print(title, steps.summary(measured), is_first=not responses)
        responses.append(measured)
        found.append(_setting(options, bench, measured, label) | _step_numbers(measured))

    def figure() -> 'Figure':
        from isa_ros.analysis.response.figures import step_figure
        return step_figure(responses, [label for label, _ in benches],
                           title if len(benches) == 1 else f'{options.loop}: step')
    _write(options, found, figure)
    return not any(measured.hunts for measured in responses)


def _refuse_units(options: Namespace, benches: Sequence[Member]) -> None:
    """Refuse, before the measurement, a figure with responses of different units."""
    symbols = sorted({bench.loop.response_unit(options.of).symbol for _, bench in benches})
    if options.out is not None and len(symbols) > 1:
        raise ConfigError(
            f'--out {options.out}: one figure cannot have responses in {" and ".join(symbols)}')


def _print(title: str, text: str, is_first: bool) -> None:
    print(f'{title}\n{text}' if is_first else f'\n{title}\n{text}', flush=True)


def _amplitude(measured: bodes.Bode | steps.StepResponse) -> str:
    unit = measured.loop.unit
    return f'{measured.amplitude / unit.scale:.4g} {unit.symbol}'


def _setting(
        options: Namespace, bench: Rig, measured: bodes.Bode | steps.StepResponse, label: str
        ) -> dict[str, Any]:
    config, unit = bench.config, measured.loop.unit
    return ({'label': label} if label else {}) | {
        'actuator': config.name, 'model': config.model, 'preset': config.preset,
        'set': dict(bench.values), 'load': bench.load, 'load_inertia': bench.inertia,
        'load_in_words': bench.load_in_words,
        'loop': bench.loop.name, 'unit': unit.symbol,
        'initial_position': config.initial_position,
        'amplitude': measured.amplitude / unit.scale}


def _numbers(measured: bodes.Bode) -> dict[str, Any]:
    response, margins, rest = measured.response, measured.margins, measured.rest
    unit, into = measured.loop.response_unit(measured.of), bodes.input_unit(measured)
    columns = {
        'frequency_hz': response.frequency, 'gain': response.gain / unit.scale,
        'phase_deg': response.phase, 'coherence': response.coherence,
        'is_trusted': response.is_trusted,
        'input_amplitude': response.input_amplitude / into.scale,
        'output_amplitude': response.output_amplitude / measured.loop.unit.scale}
    results = {
        'bandwidth_hz': measured.bandwidth,
        'gain_margin_db': margins.gain_db, 'gain_margin_hz': margins.gain_frequency,
        'phase_margin_deg': margins.phase, 'phase_margin_hz': margins.phase_frequency}
    return {
        'of': measured.of, 'response_unit': unit.symbol, 'input_unit': into.symbol,
        **{name: np.asarray(column).tolist() for name, column in columns.items()},
        'hunts': rest.hunts if rest.is_known else None,
        'ripple': rest.ripple / measured.loop.unit.scale if rest.is_known else None,
        'ripple_hz': rest.frequency if rest.hunts else None,
        **(dict.fromkeys(results) if measured.rest.hunts else results)}


def _step_numbers(measured: steps.StepResponse) -> dict[str, Any]:
    found, scale = measured.figures, measured.loop.unit.scale
    return {
        'rise_time_s': found.rise_time, 'overshoot': found.overshoot,
        'settling_time_s': found.settling_time, 'settling_band': steps.BAND,
        'steady_error': found.steady_error / scale, 'ripple': found.ripple / scale,
        'standing_error': measured.standing_error / scale, 'hunts': measured.hunts,
        't_s': measured.t.tolist(), 'reference': (measured.reference / scale).tolist(),
        'output': (measured.output / scale).tolist()}


def _write(
        options: Namespace, found: list[dict[str, Any]], figure: Callable[[], 'Figure']) -> None:
    """Write the numbers of one response, or a list of those of several, and the figure."""
    write_wanted(found[0] if len(found) == 1 else {'responses': found}, options.json)
    if options.out is not None:
        figure().savefig(options.out)
        print(options.out)
