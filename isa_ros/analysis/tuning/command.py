"""`isa tune`: find gains, show what was wanted and what is measured, write a run file."""

from argparse import Namespace
from collections.abc import Iterator, Mapping
import sys
from typing import Any

from isa_ros.analysis.response.choice import Choice, chosen, ChosenRun
from isa_ros.analysis.response.loops import units_of
from isa_ros.analysis.response.rig import Rig, rig_of
from isa_ros.analysis.tuning.design import TOLERATED_DEG, TOLERATED_SHARE, WantedLoop
from isa_ros.analysis.tuning.tune import factors, Reached, STROKES, tune as tuned_block, Tuned
from isa_ros.config.text.changes import changed, values_of
from isa_ros.config.text.parameter_sets import as_tree
from isa_ros.config.text.yaml_text import dump, Tree
from isa_ros.errors import ConfigError
from isa_ros.reu.schedule import Schedule
from isa_ros.reu.wiring import active
from isa_ros.text.json_file import write_wanted
from isa_ros.text.progress import counted
from isa_ros.text.table import aligned, Cells, RIGHT

MARGINS = (20.0, 85.0)      # deg that can be asked for
PERCENT = 0.01


def tune(options: Namespace) -> bool:
    """Tune a loop; return whether margin and bandwidth are reached at every place."""
    choice = Choice(
        name=options.name, loop=options.loop, actuator=options.actuator, preset=options.preset,
        variants=options.variant, load=options.load, values=values_of(options.set, '--set'))
    wanted = WantedLoop(options.phase_margin, options.bandwidth)
    if not MARGINS[0] <= wanted.phase_margin <= MARGINS[1]:
        raise ConfigError(
            f'--phase-margin = {wanted.phase_margin:g} deg, must be {MARGINS[0]:g} to '
            f'{MARGINS[1]:g} deg')
    named = chosen(choice)
    _refuse_without_force(named)
    bench = rig_of(named, choice)
    progress = counted(sys.stderr, 'responses')
    try:
        found = tuned_block(
            bench, wanted, _strokes(options.strokes), options.amplitude, progress)
    finally:
        if progress is not None:
            progress(1, 1)      # it may end early: the line goes before the result
    text = table(bench, wanted, found)
    print(text)
    write_wanted(_numbers(bench, wanted, found), options.json)
    if not found.is_reached:
        print(_missed(bench, wanted, found, options.out is not None))
    elif options.out is not None:
        options.out.write_text(run_file(named, found, text), encoding='utf-8')
        print(options.out)
    return found.is_reached


def _refuse_without_force(named: ChosenRun) -> None:
    """Refuse an actuator whose force block is off, as under position control."""
    is_on = active(named.run.actuator(named.actuator).sheet.reu)
    if 'force' not in is_on:
        outer = next(iter(is_on), 'position')
        raise ConfigError(
            f'{named.actuator}: reu.force is off, and gains of another block are not tuned; '
            f'isa bode --loop {outer} and isa step --loop {outer} measure what a gain does')


def _strokes(given: list[float] | None) -> tuple[float, ...]:
    if given is None:
        return STROKES
    for percent in given:
        if not 0.0 <= percent <= 100.0:
            raise ConfigError(f'--strokes {percent:g}, must be 0 to 100 % of the stroke')
    return tuple(percent * PERCENT for percent in sorted(set(given)))


def table(bench: Rig, wanted: WantedLoop, found: Tuned) -> str:
    """Return what was wanted and what is measured at each place, and the gains."""
    units = units_of(bench.config.sheet)
    place, force = units['position'], bench.loop.unit
    amplitude = found.reached[0].measured.amplitude / force.scale
    head = [f'{bench.config.name} (preset {bench.config.preset}), {bench.load_in_words}: '
            f'{bench.loop.label}, sine of {amplitude:.4g} {force.symbol}']
    rows: list[Cells] = [
        (f'position, {place.symbol}', 'phase margin, deg', '-3 dB, Hz', 'gain margin, dB',
         f'ripple, {force.symbol}'),
        ('wanted', f'{wanted.phase_margin:g} +-{TOLERATED_DEG:g}',
         f'{wanted.bandwidth:g} +-{TOLERATED_SHARE * wanted.bandwidth:g}', '', 'none')]
    rows += [_row(reached, place.scale, force.scale) for reached in found.reached]
    return '\n'.join([*head, *aligned(rows, RIGHT), *_gains(found)])


def _row(reached: Reached, place: float, force: float) -> Cells:
    measured = reached.measured
    margins, rest = measured.margins, measured.rest
    position = f'{reached.rig.config.initial_position / place:.4g}'
    if rest.hunts:
        return position, '-', '-', '-', f'{rest.ripple / force:.3g}, hunts'
    phase, band, gain = (
        '-' if value is None else f'{value:.1f}'
        for value in (margins.phase, measured.bandwidth, margins.gain_db))
    return position, phase, band, gain, f'{rest.ripple / force:.2g}'


def _gains(found: Tuned) -> Iterator[str]:
    block = found.block
    yield f'reu.force: kp {block.kp:g}, ki {block.ki:g}, kf {block.kf:g}'
    yield ('factors of the schedule from the retracted to the extended end: '
           f'{", ".join(f"{factor:g}" for factor in factors(block))}')


def _missed(bench: Rig, wanted: WantedLoop, found: Tuned, has_file: bool) -> str:
    """Return one line with the numbers that were reached."""
    hunting = [reached for reached in found.reached if reached.measured.rest.hunts]
    worst = hunting[0] if hunting else max(found.reached, key=lambda reached: reached.error)
    place = units_of(bench.config.sheet)['position']
    measured = worst.measured
    phase, band = measured.margins.phase, measured.bandwidth
    reached = 'hunting' if hunting else (
        f'{"no margin" if phase is None else f"{phase:.2f} deg"} and '
        f'{"no bandwidth" if band is None else f"{band:.2f} Hz"}')
    return (f'not reached: {wanted.phase_margin:g} deg and {wanted.bandwidth:g} Hz; farthest '
            f'{reached} at {worst.rig.config.initial_position / place.scale:.4g} {place.symbol}'
            + ('; no file is written' if has_file else ''))


def run_file(named: ChosenRun, found: Tuned, text: str) -> str:
    """Return the run with the gains as the text of a run file; ``text`` is its comment."""
    below = f'actuators.{named.actuator}.parameters.reu.force'
    tree = changed(named.tree, {
        f'{below}.{key}': value for key, value in _written(found).items()}, named.place.file)
    comment = ''.join(f'# {line}\n' for line in ['Tuned by isa tune.', *text.splitlines()])
    return comment + dump(tree)


def _written(found: Tuned) -> Tree:
    block = found.block
    return {'kp': block.kp, 'ki': block.ki, 'kf': block.kf,
            'gain_schedule': as_tree(block.gain_schedule, Schedule)}


def _numbers(bench: Rig, wanted: WantedLoop, found: Tuned) -> Mapping[str, Any]:
    units = units_of(bench.config.sheet)
    return {
        'actuator': bench.config.name, 'model': bench.config.model, 'load': bench.load,
        'load_inertia': bench.inertia, 'load_in_words': bench.load_in_words,
        'loop': bench.loop.name, 'is_reached': found.is_reached,
        'wanted': {'phase_margin_deg': wanted.phase_margin, 'bandwidth_hz': wanted.bandwidth},
        'force': _written(found),
        'places': [{
            'position': reached.rig.config.initial_position / units['position'].scale,
            'phase_margin_deg': reached.measured.margins.phase,
            'bandwidth_hz': reached.measured.bandwidth,
            'gain_margin_db': reached.measured.margins.gain_db,
            'hunts': reached.measured.rest.hunts,
            'ripple': reached.measured.rest.ripple / bench.loop.unit.scale,
        } for reached in found.reached]}
