"""The header of an exported actuator, from its template and the tables of signals and names."""

from collections.abc import Iterable, Mapping, Sequence
from importlib.resources import files
import zlib

from isa_ros.core.conditions import CONDITIONS
from isa_ros.core.device import EVENTS, MODES, STATES
from isa_ros.core.signals import SAMPLE_FIELDS
from isa_ros.core.timebase import FORCE_WINDOWS
from isa_ros.core.version import VERSION
from isa_ros.errors import printable

_TYPES = '@TYPES@'
_NUMBER_WIDTH = len('  double refused_requests;')


def source(name: str) -> str:
    """Return the text of one of the files in C."""
    return (files('isa_ros.export') / 'sources' / name).read_text(encoding='utf-8')


def filled(text: str, values: Mapping[str, str]) -> str:
    """Return a text with a value in place of each @KEY@."""
    for key, value in values.items():
        text = text.replace(f'@{key}@', value)
    return text


def header(word: str, about: str, assumed: Sequence[str] = ()) -> str:
    """
    Return the text of the header of an actuator; its names begin with ``word``.

    ``about`` says in a few words which actuator it is, ``assumed`` are values that were not given.
    The number of the types that all headers share is that of their text: headers with other types
    cannot be used together.
    """
    text = filled(source('actuator.h'), {
        'NAME': word, 'GUARD': word.upper(), 'ABOUT': in_comment(about),
        'ASSUMED': _assumed(assumed), 'VERSION': VERSION,
        'WINDOWS': str(FORCE_WINDOWS), 'ENUMERATIONS': _enumerations(), 'SAMPLE': _sample()})
    _, _, types = text.partition(f'#define ISA_ACTUATOR_TYPES {_TYPES}')
    number = zlib.crc32(types.partition('#elif')[0].encode())
    return text.replace(_TYPES, f'0x{number:08x}')


def in_comment(text: str) -> str:
    """Return a text as one line of a comment of C."""
    return printable(text).replace('*/', '* /')


def _assumed(values: Sequence[str]) -> str:
    """Return the lines of a comment about values that were not given."""
    lines = ('', 'Assumed, since --set did not give them:', *values) if values else ()
    return ''.join(f'\n *{f" {in_comment(line)}" if line else ""}' for line in lines)


def upper(name: str) -> str:
    """Return a name as part of a constant of C."""
    return name.upper().replace(' ', '_')


def _enumerations() -> str:
    """Return the enumerations of modes, states, events and conditions."""
    bits = [(condition.name, 1 << k, condition.meaning) for k, condition in enumerate(CONDITIONS)]
    return '\n\n'.join((
        _enumeration('Named after the outermost block that runs.', 'mode', _numbered(MODES)),
        _enumeration('Of isa_sample.device_state.', 'state', _numbered(STATES)),
        _enumeration('Of isa_sample.device_event.', 'event', _numbered(EVENTS)),
        _enumeration('Bits of isa_sample.trips, warnings, first_trip and last_trip.',
                     'condition', bits)))


def _numbered(names: Iterable[str]) -> list[tuple[str, int, str]]:
    return [(name, number, '') for number, name in enumerate(names)]


def _enumeration(what: str, kind: str, rows: list[tuple[str, int, str]]) -> str:
    """Return an enumeration, its rows a name, number and meaning each."""
    lines = [
        f'  ISA_{kind.upper()}_{upper(name)} = {number}'
        + (',' if k + 1 < len(rows) else '') + (f'   /* {meaning} */' if meaning else '')
        for k, (name, number, meaning) in enumerate(rows)]
    return '\n'.join([f'/* {what} */', f'enum isa_{kind} {{', *lines, '};'])


def _sample() -> str:
    """Return the fields of `SAMPLE`, which are numbers alone."""
    return '\n'.join(
        f'{f"  double {field.name};":{_NUMBER_WIDTH}}   /* {field.unit}: {field.meaning} */'
        for field in SAMPLE_FIELDS)
