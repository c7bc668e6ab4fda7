"""The tables of docs/objects.md and of `isa bus describe`, from the data of the devices."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import groupby
import re

from isa_ros.core.conditions import CONDITIONS, ErrorCode
from isa_ros.fieldbus.device import cia402_objects
from isa_ros.fieldbus.device import cia402_states
from isa_ros.fieldbus.device import cia408_objects
from isa_ros.fieldbus.device import cia408_states
from isa_ros.fieldbus.device.bus_device import BusDevice
from isa_ros.fieldbus.device.faults import OWN_CODES
from isa_ros.fieldbus.device.objects import Object, ObjectCode, ObjectEntry, ObjectTable
from isa_ros.fieldbus.device.process_data import is_mapping, RECEIVE, TRANSMIT
from isa_ros.fieldbus.device.states import Transition
from isa_ros.text.marked import with_parts
from isa_ros.text.table import aligned, markdown

Rows = list[tuple[str, ...]]
HEADER = ('index', 'sub', 'name', 'type', 'access', 'PDO', 'unit', 'SI per count', 'meaning')
_NUMBER = re.compile(r' \d ')
_SEVERAL = '..'
_COMMUNICATION, _MANUFACTURER, _PROFILE = (
    range(0x1000, 0x2000), range(0x2000, 0x6000), range(0x6000, 0xA000))


def table_lines(device: BusDevice) -> list[str]:
    """Return the objects of a device for a terminal, with their values at power-on."""
    header, *rows = object_rows(device.table.objects)
    return aligned([
        (*header[:-1], 'at power-on', header[-1]),
        *((*row[:-1], _at_power_on(device.table, *row[:2]), row[-1]) for row in rows)])


def _at_power_on(table: ObjectTable, index: str, subindex: str) -> str:
    """Return the value in counts of what a row shows; '': of several, or it changes by itself."""
    if _SEVERAL in index + subindex:
        return ''
    entry = table.entry(int(index, 16), int(subindex))
    if entry.access == 'ro':
        return ''
    return entry.default if isinstance(entry.default, str) else f'{entry.default:.9g}'


def object_rows(objects: Sequence[Object]) -> Rows:
    """
    Return a row for each entry.

    Equal entries of an array share one, so do consecutive objects that differ by their number;
    the highest subindex of a record has none.
    """
    rows: Rows = [HEADER]
    for _, group in groupby(enumerate(objects), _alike):
        alike = [one for _, one in group]
        rows += _rows(alike[0], alike[-1].index)
    return rows


def _alike(place: tuple[int, Object]) -> tuple[object, ...]:
    """Return what consecutive objects have in common that share their rows."""
    k, one = place
    if one.kind is ObjectCode.VAR:
        return one.index,
    return one.index - k, _without_number(one.name), tuple(
        _row('', entry, '') for entry in one.entries)


def _without_number(name: str) -> str:
    return _NUMBER.sub(' n ', name)


def _rows(one: Object, last: int) -> Iterator[tuple[str, ...]]:
    """Yield the rows of an object, and of those alike up to index ``last``."""
    index, name = f'0x{one.index:04X}', one.name
    if last != one.index:
        index, name = f'{index}..0x{last:04X}', _without_number(name)
    first, *others = one.entries
    if one.kind is ObjectCode.VAR:
        yield _row(index, first, name)
    elif one.kind is ObjectCode.ARRAY and len({_row('', entry, '', '') for entry in others}) == 1:
        yield _row(index, first, f'{name}: number of entries')
        yield _row(index, others[0], f'{name}: entries', f'1..{others[-1].subindex}')
    else:
        for entry in others:
            yield _row(index, entry, name if entry.name == name else f'{name}: {entry.name}')


def _row(
        index: str, entry: ObjectEntry, name: str, subindex: str | None = None) -> tuple[str, ...]:
    return (
        index, str(entry.subindex) if subindex is None else subindex, name,
        entry.data_type.name, entry.access, entry.pdo, entry.unit,
        f'{entry.scale:g}' if entry.scale != 1.0 else '', entry.meaning)


def _in(table: ObjectTable, indices: range) -> list[Object]:
    return [one for one in table if one.index in indices]


def pdo_rows(device: BusDevice) -> Rows:
    """Return the process data by default: a row for each PDO."""
    rows: Rows = [('PDO', 'bytes', 'content')]
    for first in (RECEIVE, TRANSMIT):
        for one in device.table:
            if is_mapping(one.index) and one.index - first in range(0x200):
                words = [int(entry.default) for entry in one.entries[1:]]
                content = ', '.join(
                    _mapped(device, word) for word in words[:int(one.entries[0].default)])
                rows.append((f'0x{one.index:04X}', str(device.size(one.index)), content or '-'))
    return rows


def _mapped(device: BusDevice, word: int) -> str:
    index, subindex, bits = word >> 16, word >> 8 & 0xFF, word & 0xFF
    if not index:
        return f'{bits} bits unused'
    place = f'0x{index:04X}' if device.table.at(index).kind is ObjectCode.VAR else (
        f'0x{index:04X}:{subindex}')
    return f'{place} {device.table.entry(index, subindex).name}'


def states_of(transitions: Sequence[Transition]) -> Rows:
    """Return the transitions of a profile."""
    return [('no.', 'state', 'event', 'if', 'next state', 'effect'), *(
        (str(row.number), row.state.words, row.event.value, row.guard, row.following.words,
         row.does) for row in transitions)]


def commands_402() -> Rows:
    """Return the patterns of the control word of CiA 402."""
    rows: Rows = [('control word', 'command')]
    for one in cia402_states.COMMANDS:
        bits = ''.join('x' if not one.mask >> bit & 1 else str(one.value >> bit & 1)
                       for bit in range(7, -1, -1))
        rows.append((f'xxxx xxxx {bits[:4]} {bits[4:]}', one.event.value))
    return [*rows, ('bit 7 rises', 'fault reset')]


def status_402() -> Rows:
    """Return the states of CiA 402 with their status word."""
    return [('state', f'status word & 0x{cia402_states.STATE_MASK:02X}'), *(
        (one.words, f'0x{one.bits:02X}') for one in cia402_states.State402)]


def modes_402() -> Rows:
    """Return the modes of operation, and why others are refused."""
    return [('0x6060', 'mode', 'refused because'), *(
        (str(mode), name, '') for mode, name in cia402_objects.MODE_NAMES.items()), *(
        (str(mode), '', reason) for mode, reason in cia402_objects.REFUSED_MODES.items())]


def status_408() -> Rows:
    """Return the states of CiA 408 with the bits of their status word."""
    return [('state', 'R M H D'), *(
        (one.words, ' '.join(str(one.bits >> bit & 1) for bit in range(3, -1, -1)))
        for one in cia408_states.State408)]


def modes_408() -> Rows:
    """Return the control modes."""
    needs = {cia408_objects.OPEN_LOOP: 'current', cia408_objects.CLOSED_LOOP: 'spool',
             cia408_objects.PQ: 'pressure'}
    return [('0x6043', 'control mode', 'mode of the REU'), *(
        (str(mode), name, needs.get(mode, 'position or impedance'))
        for mode, name in cia408_objects.MODE_NAMES.items())]


def error_rows() -> Rows:
    """Return the error codes: of the conditions of the device, then of the bus interface."""
    rows: Rows = [('condition', 'code', 'register', 'meaning in the profile')]
    for condition in CONDITIONS:
        rows.append((f'`{condition.name}`', *_code(condition.error)))
    return [*rows, *(('the bus interface', *_code(one)) for one in OWN_CODES)]


def _code(one: ErrorCode) -> tuple[str, str, str]:
    return f'0x{one.code:04X}', f'0x{one.register | 1:02X}', one.words


def tables(device_402: BusDevice, device_408: BusDevice) -> Mapping[str, Callable[[], Rows]]:
    """Return a function for each table of the page by its name."""
    table = device_402.table
    return {
        'states402': lambda: states_of(cia402_states.TRANSITIONS),
        'commands402': commands_402, 'status402': status_402,
        'modes402': modes_402, 'pdos402': lambda: pdo_rows(device_402), 'errors': error_rows,
        'profile402': lambda: object_rows(_in(table, _PROFILE)),
        'communication': lambda: object_rows(_in(table, _COMMUNICATION)),
        'manufacturer': lambda: object_rows(_in(table, _MANUFACTURER)),
        'states408': lambda: states_of(cia408_states.TRANSITIONS),
        'status408': status_408, 'modes408': modes_408,
        'pdos408': lambda: pdo_rows(device_408),
        'profile408': lambda: object_rows(_in(device_408.table, _PROFILE))}


def with_tables(page: str, device_402: BusDevice, device_408: BusDevice) -> str:
    """Return a page with its tables anew; `isa_ros.text.marked` has the form of their marks."""
    return with_parts(page, {
        f'table {name}': markdown(rows())
        for name, rows in tables(device_402, device_408).items()})
