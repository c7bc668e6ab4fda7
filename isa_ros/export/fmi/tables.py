"""The tables of a unit as text of C: its variables, and the memory of its supply."""

from collections.abc import Iterable, Iterator, Sequence
import re

from isa_ros.export.exported import Exported
from isa_ros.export.fmi.inputs import modes_of, PORT_FIELDS
from isa_ros.export.fmi.supply import UnitSupply
from isa_ros.export.fmi.tuned import TunedValue
from isa_ros.export.fmi.variables import Home, Type, Variable
from isa_ros.export.layout import ALIGNED
from isa_ros.export.tables import number, quoted
from isa_ros.reu.bumpless import EVERY_BLOCK
from isa_ros.reu.wiring import possible_modes
from isa_ros.surroundings.supply_sample import SUPPLY_FIELDS
import numpy as np

_NOT_OF_A_WORD = re.compile('[^A-Z0-9]')


def header(own: Exported, supply: UnitSupply, table: Sequence[Variable], token: str) -> str:
    """Return the text of the tables' header."""
    inputs = [variable for variable in table if variable.home is Home.INPUT]
    layout, modes = supply.layout(), possible_modes(own.chosen.config.sheet.reu)
    return '\n'.join([
        f'/* The unit of {own.word}: its variables, and the memory of its supply. */',
        '#ifndef ISA_TABLES_H', '#define ISA_TABLES_H', '', f'#include "{own.word}.h"',
        '#include "types.h"', '', f'#define ISA(name) {own.word}_##name', '',
        *_defined((
            ('TOKEN', quoted(token)), ('STEP_NS', own.step_ns),
            ('LIMITS', int(own.actuator.setpoint_range.limits)),
            ('HAS_PORT', int(not own.has_own_load)), ('HAS_FEED', int(supply.has_feed)),
            ('MODES', sum(1 << mode for mode in modes)), ('MODE_NAMES', quoted(modes_of(modes))),
            ('VARIABLE_COUNT', len(table)), ('INPUTS', len(inputs)),
            ('PORT_INPUTS', len(PORT_FIELDS)), ('SUPPLY_ALIGNED', ALIGNED),
            ('SUPPLY_BYTES', layout.size), ('SUPPLY_WORDS', len(_words(supply))),
            ('ANSWER_BYTES', supply.answers.nbytes),
            *((f'AT_{name}', layout.place(rows) if rows.size else 0) for name, rows in (
                ('SUPPLY', supply.sample), ('PORT', supply.ports), ('FEED', supply.feeds),
                ('REPLY', supply.replies), ('FED', supply.fed), ('ANSWERS', supply.answers))))),
        '', '/* Places of the inputs. */', 'enum input {',
        *(f'  IN_{_NOT_OF_A_WORD.sub("_", variable.name.upper())} = {variable.place},'
          for variable in inputs),
        '};', '', *_declared(), '', '#endif', ''])


def _declared() -> Iterator[str]:
    """Yield the sample of the supply, and the declarations of the tables."""
    yield '/* `SUPPLY_SAMPLE`. */'
    yield 'typedef struct {'
    yield from (f'  double {field.name};' for field in SUPPLY_FIELDS)
    yield from (
        '} supply_sample_t;', '', 'extern const struct variable VARIABLES[];',
        'extern const double NUMBERS[], DEFAULTS[INPUTS];', 'extern const char *const TEXTS[];',
        'extern const struct word WORDS[SUPPLY_WORDS];',
        'extern const uint64_t SUPPLY_IMAGE[SUPPLY_BYTES / 8];',
        'extern const struct call BEFORE[], AFTER[];', 'extern const struct tuned TUNED[];',
        'extern const size_t BEFORE_COUNT, AFTER_COUNT, TUNED_COUNT;', '',
        '/* Of the actuator: whether its loops are on, and a current without a jump. */',
        'extern const int32_t IS_ON, FADE, EVERY_BLOCK;',
        'void ISA(put_number)(ISA(t) *self, int32_t place, double value);',
        'int64_t *ISA(flag)(ISA(t) *self, int32_t place);',
        'uint64_t ISA(checksum)(const unsigned char *state, size_t bytes);')


def _words(supply: UnitSupply) -> list[str]:
    """Return the words of the tables of all kernels, one after the other."""
    layout = supply.layout()
    return [f'{{{word.value}, {int(word.is_place)}}}' for one in supply.kernels
            for word in layout.table(one.memory)]


def source(
        own: Exported, supply: UnitSupply, table: Sequence[Variable],
        may_change: Sequence[TunedValue]) -> str:
    """Return the text of the tables."""
    inputs = {variable.name: variable.place for variable in table if variable.home is Home.INPUT}
    layout = supply.layout()
    called = supply.kernels
    ends = np.cumsum([0, *(len(list(layout.table(one.memory))) for one in called)])
    calls = [f'{{{one.name}, {at}}}' for one, at in zip(called, ends)]
    split = len(supply.before)
    status = own.ticked.memory.reu['status']
    of_actuator = own.layout()
    return '\n'.join([
        '#include "tables.h"', '', '#include <math.h>', '',
        *(f'int64_t {name}(const int64_t *table);'
          for name in dict.fromkeys(one.name for one in called)), '',
        *_array('struct variable VARIABLES', map(_variable, table)),
        *_array('double DEFAULTS', (
            number(float(own.start or 0.0)) for own in table if own.home is Home.INPUT)),
        *_array('double NUMBERS', (
            number(float(own.start or 0.0)) for own in table if own.home is Home.NUMBER)),
        *_array('char *const TEXTS', (
            quoted(str(own.start)) for own in table if own.home is Home.TEXT)),
        *_array('struct word WORDS', _words(supply)),
        *_array('uint64_t SUPPLY_IMAGE', (f'0x{word:016x}' for word in layout.image())),
        *_array('struct call BEFORE', calls[:split]), *_array('struct call AFTER', calls[split:]),
        *_array('struct tuned TUNED', [
            f'{{{inputs[one.name]}, {one.place}}}' for one in may_change] or ['{0, 0}']),
        f'const size_t BEFORE_COUNT = {split}, AFTER_COUNT = {len(calls) - split};',
        f'const size_t TUNED_COUNT = {len(may_change)};',
        f'const int32_t IS_ON = {of_actuator.place(status["is_on"])}, '
        f'FADE = {of_actuator.place(status["fade"]["begins"])}, EVERY_BLOCK = {EVERY_BLOCK};', ''])


def _array(name: str, rows: Iterable[str]) -> Iterator[str]:
    yield f'const {name}[] = {{'
    yield from (f'  {row},' for row in rows)
    yield from ('};', '')


def _variable(own: Variable) -> str:
    """Return the row of a variable; a number without a range may be any."""
    low = '-INFINITY' if own.low is None else number(own.low)
    high = 'INFINITY' if own.high is None else number(own.high)
    unit = '' if own.unit == '1' or own.kind is not Type.REAL else own.unit
    return (f'{{{quoted(own.name)}, {quoted(unit)}, {low}, {high}, {own.place}, '
            f'TYPE_{own.kind.name}, HOME_{own.home.name}}}')


def _defined(values: Iterable[tuple[str, object]]) -> Iterator[str]:
    yield from (f'#define {name} {value}' for name, value in values)
