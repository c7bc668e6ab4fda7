"""
How a change runs over its time: steadily, as a waveform, as a ramp, or on and off.

The keys ``sine`` and the like, ``ramp_s`` and ``intermittent`` of a fault or change.
"""

from collections.abc import Mapping
from dataclasses import replace

from isa_ros.config.runs.tick_grid import ticks_in
from isa_ros.config.text.parameter_sets import build
from isa_ros.config.text.sections import Place, refuse_unknown, section_at, written
from isa_ros.config.text.yaml_text import Tree
from isa_ros.core.changeable import Changeable
from isa_ros.core.noise import seed_of
from isa_ros.core.parameter import check
from isa_ros.errors import ConfigError
from isa_ros.scenario.fault_courses import INTERMITTENT, Intermittent, RAMP, Ramp
from isa_ros.scenario.faults import Fault
from isa_ros.scenario.setpoints import MAX_DURATION
from isa_ros.scenario.waveforms import EFFORT, MOVES, Waveform, WAVEFORMS

COURSES = (RAMP, INTERMITTENT, *WAVEFORMS)
"""Keys of which a fault has one at most."""
_COURSE = {'period_s': ('time from one begin to the next', 's', {'gt': 0.0, 'le': MAX_DURATION}),
           'duty': ('part of the time in which it is on', '1', {'gt': 0.0, 'lt': 1.0})}


def with_course(
        fault: Fault, tree: Tree, known: Mapping[str, Changeable], step_ns: int, place: Place
        ) -> Fault:
    """
    Return the fault with its waveform, its ramp, or its times on and off.

    ``known`` are the values that may change, by name.

    Raises
    ------
    ConfigError
        Several courses, one that does not fit the values or the ticks, or one that is malformed.

    """
    given = [key for key in COURSES if key in tree]
    if len(given) > 1:
        raise ConfigError(place.has(f'has {" and ".join(given)}, must have one of them'))
    between = [key for key in given if key != INTERMITTENT]
    whole = [name for name in fault.values if 'is_whole' in known[name].declared]
    if between and whole:
        raise ConfigError(f'{place / between[0]} is not used: {known[whole[0]].key} takes whole '
                          'numbers only')
    if RAMP in tree:
        ticks = tick_at(tree, RAMP, place, step_ns)
        if ticks == 0:
            raise ConfigError(f'{place}.{RAMP} = 0 s, must be > 0 s; without it values jump')
        first = {name: known[name].value for name in fault.values}
        return replace(fault, course=Ramp(ticks, first))
    if INTERMITTENT in tree:
        return replace(fault, course=_intermittent(tree, fault, step_ns, place))
    return replace(fault, wave=_wave(tree, fault.values, step_ns, place))


def _intermittent(tree: Tree, fault: Fault, step_ns: int, place: Place) -> Intermittent:
    if fault.until is None:
        raise ConfigError(place.has(f'has {INTERMITTENT}: needs until_s'))
    below = place / INTERMITTENT
    section = section_at(tree[INTERMITTENT], below)
    refuse_unknown(section, (*_COURSE, 'seed'), below)
    for key, (doc, unit, bounds) in _COURSE.items():
        if key not in section:
            raise ConfigError(below.has(f'lacks {key}'))
        check(f'{below}.{key}', section[key], {'doc': doc, 'unit': unit, 'bounds': bounds})
    period, duty = tick_at(section, 'period_s', below, step_ns), float(
        section['duty'])    # type: ignore[arg-type]
    if 'seed' in section:
        seed = seed_of(section['seed'], f'{below}.seed')
        return Intermittent(period, duty, seed, fault.target)
    if not 0 < round(duty * period) < period:
        raise ConfigError(
            f'{below}.duty = {duty:g}, must be at least one tick of the {period} ticks of '
            'period_s, and leave one')
    return Intermittent(period, duty, None, fault.target)


def _wave(
        tree: Tree, values: Mapping[str, float], step_ns: int, place: Place) -> Waveform | None:
    """Return the waveform of a fault, in the unit of messages; None: it has none."""
    given = [kind for kind in WAVEFORMS if kind in tree]
    if not given:
        return None
    if len(values) != 1 or 'until_s' not in tree:
        raise ConfigError(place.has(
            f'has {given[0]}: needs one value in set, and until_s'))
    kind, below = given[0], place / given[0]
    section = section_at(tree[kind], below)
    if MOVES in section:
        raise ConfigError(f'{below / MOVES} is not used: it is added to {next(iter(values))}')
    wave = build(WAVEFORMS[kind], written(section | {MOVES: EFFORT}, below), below)
    wave.refuse_step(step_ns, str(below))
    return wave


def tick_at(tree: Tree, key: str, place: Place, step_ns: int) -> int:
    """Return the tick of the time at ``key``; raises `ConfigError` if that is between ticks."""
    if key not in tree:
        raise ConfigError(place.has(f'lacks {key}'))
    check(f'{place}.{key}', tree[key], {
        'doc': 'time', 'unit': 's', 'bounds': {'ge': 0.0, 'le': MAX_DURATION}})
    return ticks_in(float(tree[key]), step_ns, f'{place}.{key}')  # type: ignore[arg-type]
