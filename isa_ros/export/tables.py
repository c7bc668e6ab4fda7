"""The tables of an exported actuator as text of C: places in its memory, values, names."""

from collections.abc import Callable, Iterable, Iterator, Sequence
import math
from typing import Any

from isa_ros.actuator.integration import state_name, STATE_SIZE
from isa_ros.actuator.setpoint_range import (
    Bounds, LIMIT, load_positions, positions, reference_bounds, setpoint_bounds)
from isa_ros.core.constants import ATMOSPHERE
from isa_ros.core.device import MODES
from isa_ros.core.fields import units_of
from isa_ros.core.saved_state import MAX_TICKS, TIME_BYTES
from isa_ros.core.signals import EVERY_KIND, SAMPLE_FIELDS
from isa_ros.core.timebase import PLANT_STEP_NS
from isa_ros.core.units import of_coordinate
from isa_ros.core.version import VERSION
from isa_ros.export.exported import Exported
from isa_ros.export.layout import MemoryLayout
from isa_ros.export.starting import start_forces
from isa_ros.export.state_checks import Check, checks, FINITE, GAIN
from isa_ros.reu.wiring import possible_modes
from isa_ros.surroundings.circuits.accumulator import ICE
import numpy as np

_FIELDS = ('position', 'velocity', 'effort', 'stiffness', 'damping')
_ASCII = 128
_EVERYTHING = Bounds(-math.inf, math.inf, '', '')


def tables(own: Exported) -> str:
    """Return the text of the tables, an include file of the source."""
    layout = own.layout()
    return '\n'.join([
        f'/* Tables of {own.word}: places are bytes from the begin of its memory. */',
        f'#include "{own.word}.h"', '', f'#define ISA(name) {own.word}_##name', '',
        *_places(own, layout), '', *_kernels(own, layout), '', *_image(layout), '',
        *_setpoints(own), '', *_state(own, layout), '', *_names(own), ''])


def quoted(text: str) -> str:
    """Return a text as a string of C: bytes that it may read otherwise are octal numbers."""
    return '"' + ''.join(
        chr(byte) if chr(byte).isprintable() and byte < _ASCII and chr(byte) not in '"\\?'
        else f'\\{byte:03o}' for byte in text.encode()) + '"'


def number(value: float) -> str:
    """Return a float as C writes it, exactly."""
    if math.isnan(value):
        return 'NAN'
    if math.isinf(value):
        return '-INFINITY' if value < 0.0 else 'INFINITY'
    return repr(float(value))


def _array(kind: str, name: str, rows: Iterable[str]) -> Iterator[str]:
    """Yield the lines of an array; C has none without a row."""
    yield f'static const {kind} {name}[] = {{'
    yield from (f'  {row},' for row in rows)
    yield '};'


def _defined(values: Iterable[tuple[str, Any]]) -> Iterator[str]:
    yield from (f'#define {name} {value}' for name, value in values)


def _places(own: Exported, layout: MemoryLayout) -> Iterator[str]:
    """Yield the places of what the source reads and writes."""
    ticked, memory = own.ticked, own.ticked.memory
    yield from _defined([
        ('BLOCK_BYTES', layout.size),
        *((f'AT_{name}', layout.place(array)) for name, array in (
            ('CLOCK', ticked.clock), ('START', own.starting.memory.start),
            ('PORT', ticked.ports), ('PORT_IN_FORCE', memory.ports),
            ('COMMAND', ticked.commands), ('FEED', memory.feeds),
            ('REPLY', memory.replies), ('FED', memory.fed), ('APPLIED', memory.applied),
            ('SAMPLE', memory.observed), ('OWN_SAMPLE', memory.samples),
            ('LOAD_POSITION', memory.continuous['load']['position']),
            ('MODE', memory.reu['status']['requested_mode']),
            ('SETPOINT_POSITION', memory.reu['setpoint']['position']))),
        ('PLANT_STEP_NS', PLANT_STEP_NS),
        ('HAS_OWN_LOAD', int(own.has_own_load)), ('HAS_LINK', int(own.actuator.has_link))])


def _kernels(own: Exported, layout: MemoryLayout) -> Iterator[str]:
    """Yield the kernels, and the tables of their memories one behind the other."""
    words = [list(layout.table(one.memory)) for one in own.kernels]
    ends = np.cumsum([0, *map(len, words)])
    for what, one, at in zip(('START', 'TICK'), own.kernels, ends):
        yield f'int64_t {one.name}(const int64_t *table);'
        yield from _defined([(f'{what}_KERNEL', one.name), (f'{what}_TABLE', at)])
    yield '/* Numbers of their tables: a place, whose address it becomes, or a length. */'
    yield from _array('struct word', 'WORDS', [
        f'{{{word.value}, {int(word.is_place)}}}' for table in words for word in table])


def _image(layout: MemoryLayout) -> Iterator[str]:
    """Yield words of the memory before a start by their places."""
    yield '/* What the memory holds before a start; the rest is 0. */'
    image = layout.image()
    yield from _array('struct image', 'IMAGE', [
        f'{{{8 * at}, 0x{image[at]:016x}}}' for at in np.flatnonzero(image)])


def _setpoints(own: Exported) -> Iterator[str]:
    """Yield the ranges of setpoints, references and positions, and the modes."""
    config = own.chosen.config
    sheet = config.sheet
    bounds, references = setpoint_bounds(sheet), reference_bounds(sheet)
    yield from _array('struct range', 'RANGES', [
        *(_bounds(bounds.get(field, _EVERYTHING), field) for field in _FIELDS),
        *(_bounds(references.get(mode, _EVERYTHING), f'reference, mode {name}')
          for mode, name in enumerate(MODES))])
    (low, high, _, _), load = positions(sheet), load_positions(sheet)
    pulled, pushed = start_forces(config, float(own.start['force'][0]))
    yield from _defined([
        ('EVERY_KIND', EVERY_KIND),
        ('REFERENCES', sum(1 << mode for mode in references)),
        ('POSSIBLE_MODES', sum(1 << mode for mode in possible_modes(sheet.reu))),
        ('LIMITS', int(config.beyond_range == LIMIT)),
        ('POSITION_LOW', number(low)), ('POSITION_HIGH', number(high)),
        ('LOAD_LOW', number(load.low)), ('LOAD_HIGH', number(load.high)),
        ('FORCE_LOW', number(pulled)), ('FORCE_HIGH', number(pushed)),
        ('VACUUM', number(-ATMOSPHERE)), ('COLDEST', number(-ICE))])


def _bounds(bounds: Bounds, what: str) -> str:
    return f'{{{number(bounds.low)}, {number(bounds.high)}}} /* {what} */'


def _state(own: Exported, layout: MemoryLayout) -> Iterator[str]:
    """Yield what a saved state has and what its numbers may be."""
    rows = own.actuator.saved.rows
    actuator = own.actuator
    tail = actuator.tuning.snapshot() + actuator.digest.encode()
    fed = own.ticked.memory.fed
    at_tail = TIME_BYTES + sum(part.nbytes for _, part in rows)
    yield ('/* A saved state: the time, these parts of the memory, these bytes, isa_fed, the '
           'checksum. */')
    yield from _array('struct part', 'SAVED', [
        f'{{{layout.place(part)}, {part.nbytes}}} /* {name} */' for name, part in rows])
    yield from _array('unsigned char', 'TAIL', _lines(tail, lambda byte: f'0x{byte:02x}'))
    yield from _array('struct check', 'CHECKS', map(_check, [
        *checks(rows), *checks([('fed', fed)], at_tail + len(tail))]))
    yield from _defined([
        ('STEP_NS', own.step_ns), ('MAX_TICKS', f'INT64_C({MAX_TICKS})'),
        ('OF_FLOAT', FINITE), ('OF_GAIN', GAIN),
        ('SAVED_TAIL', at_tail)])


def _lines(values: Sequence[int], text: Callable[[int], str], a_line: int = 16) -> Iterator[str]:
    """Yield rows with several values each."""
    for k in range(0, len(values), a_line):
        yield ', '.join(map(text, values[k:k + a_line]))


def _check(own: Check) -> str:
    return f'{{{own.at}, {own.length}, {own.size}, {own.largest}}} /* {own.first} */'


def _names(own: Exported) -> Iterator[str]:
    """Yield names and units of signals, parameters and states, and what the actuator is."""
    is_rotary = own.actuator.is_rotary
    units = units_of(SAMPLE_FIELDS, is_rotary)
    yield from _array('isa_field_t', 'FIELDS', [
        _row(field.name, units[field.name], field.meaning) for field in SAMPLE_FIELDS])
    yield from _array('isa_parameter_t', 'PARAMETERS', [
        f'{{{quoted(row.parameter)}, {quoted(row.value)}, '
        f'{number(value) if isinstance(value, float) else "NAN"}, '
        + ', '.join(map(quoted, (
            of_coordinate(row.unit, is_rotary), row.bounds, row.source, row.meaning))) + '}'
        for row, value in own.chosen.parameters()])
    yield from _array('char *const', 'STATE_NAMES', [
        quoted(f'{state_name(k)} is not finite: the model has diverged')
        for k in range(STATE_SIZE)])
    config = own.chosen.config
    start = ', '.join(number(value) for value in own.start[0].item())
    yield (f'static const isa_about_t ABOUT = {{{quoted(config.name)}, {quoted(config.model)}, '
           f'{quoted(VERSION)}, {quoted(own.actuator.digest)}, {own.step_ns}, {int(is_rotary)}, '
           f'{int(own.has_own_load)}, {{{start}}}}};')


def _row(*texts: str) -> str:
    return f'{{{", ".join(map(quoted, texts))}}}'
