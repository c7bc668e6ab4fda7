"""Outcomes of faults as text, as JSON, and as the page docs/device_faults.md."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from isa_ros.analysis.faults.measure import (
    BEGIN_S, CLEAR_S, DeviceReport, END_S, FaultEffect, SOUND, VISIBLE, Visible)
from isa_ros.analysis.faults.recorded import in_mm, in_newtons
from isa_ros.analysis.faults.rigs import ABOUT, LINK
from isa_ros.config.models.fault_catalogue import fault_catalogue, NamedFault
from isa_ros.text.page import Page
from isa_ros.text.table import aligned, digits

PAGE = 'device_faults.md'
HEADER = ('fault', 'seen first in', 'after, ms', 'largest differences, or why none', 'device',
          'position error, mm', 'force error, N', 'sound again after, ms')
MESSAGE_HEADER = ('fault', 'message on /diagnostics')
LIST_HEADER = ('fault', 'of', 'set', 'meaning')
_SHOWN = {'Pa': ('MPa', 1e-6), 'm': ('mm', 1e3), 'A': ('mA', 1e3)}
_LARGEST = 3    # signals in a row of the table
_HEAD = f"""# Faults of the device

Each fault of the catalogue, `./isa faults --list`, in an ISA v5 that moves 50 kg by 20 mm at 2 Hz,
fed by a pump with an accumulator; those of parts, such as hoses or the parts of a circuit, in a
rig that has the part. Each begins at {BEGIN_S:g} s, where the piston is fastest, and
ends at {END_S:g} s. For a fault of the link there is one, with frames each ms and a watchdog of
{LINK['watchdog_ms']:g} ms. Written by

    ./isa faults --out docs

A fault is seen in a signal that the REU measures, or in the supply's pressure, once it differs
from that of the same run without the fault by more than {VISIBLE:g} steps of its converter. The
largest differences are those of the first three such signals while the fault lasts. A device is
sound again once all signals are within {SOUND:g} steps of that run, 1 % of their ranges. *Device*
has what the actuator itself reports, its warnings, trips and state, and when. The errors of
position and force are the largest distances from the sound run while the fault lasts, of the
piston and of the force in the sensor themselves, whatever the sensors read; where the device
reports *nothing*, that is what the fault costs unnoticed. A trip keeps its outputs off until it is
cleared: `~/clear_fault`, then `~/enable`, at {CLEAR_S:g} s; until then nothing holds the load."""

_MESSAGES = """The message of the device on `~/device` and, as the task *device*, on
`/diagnostics`: the first one of the gravest level. With all other faults it is that of a sound
device, `enabled, mode impedance: initialised`. While its link is lost it does not arrive."""


def listing() -> str:
    """Return every fault of the catalogue, a line each."""
    return '\n'.join(aligned([LIST_HEADER, *(
        (fault.name, fault.of, _set(fault), fault.meaning)
        for fault in fault_catalogue().values())]))


def _set(fault: NamedFault) -> str:
    own = ', '.join(f'{key}: {value:g}' for key, value in fault.values.items())
    of_part = ', '.join(f'parts.{fault.part.upper()}.{key}: {value:g}'
                        for key, value in fault.part_values.items())
    return '; of a circuit '.join(one for one in (own, of_part) if one)


def as_text(found: Sequence[FaultEffect]) -> str:
    """Return the tables for a terminal: effects, and messages if there is one."""
    tables = [_rows(found), _messages(found)]
    return '\n\n'.join('\n'.join(aligned(rows)) for rows in tables if len(rows) > 1)


def _rows(found: Sequence[FaultEffect]) -> list[tuple[str, ...]]:
    return [HEADER, *(_cells(own) for own in found)]


def _cells(own: FaultEffect) -> tuple[str, ...]:
    if own.diverged:
        return (own.fault.name, own.diverged, *[''] * (len(HEADER) - 2))
    first = own.visible[0] if own.visible else None
    return (own.fault.name, 'not seen' if first is None else first.signal,
            '' if first is None else f'{first.after_s * 1e3:g}',
            ', '.join(_difference(one) for one in _largest(own)) or own.fault.unseen,
            ', '.join(_note(one) for one in own.noticed) or _nothing(own.fault),
            in_mm(own.position_error), in_newtons(own.force_error),
            'not in this run' if own.recovered_s is None else f'{own.recovered_s * 1e3:g}')


def _nothing(fault: NamedFault) -> str:
    return f'nothing: {fault.unreported}' if fault.unreported else 'nothing'


def _messages(found: Sequence[FaultEffect]) -> list[tuple[str, ...]]:
    return [MESSAGE_HEADER, *((own.fault.name, own.message) for own in found if own.message)]


def _largest(own: FaultEffect) -> Sequence[Visible]:
    """Return the signals that a person would look at first: the earliest ones."""
    return own.visible[:_LARGEST]


def _difference(one: Visible) -> str:
    unit, scale = _SHOWN.get(one.unit, (one.unit, 1.0))
    return f'{one.signal} {digits(one.largest * scale, 3)} {unit}'


def _note(one: DeviceReport) -> str:
    return f'{one.kind} {one.name} after {one.after_s * 1e3:g} ms'


def as_tree(found: Sequence[FaultEffect]) -> dict[str, Any]:
    """Return every outcome for JSON."""
    return {'faults': [{
        'name': own.fault.name, 'of': own.fault.of, 'set': dict(own.fault.values),
        'part': own.fault.part, 'part_set': dict(own.fault.part_values), 'rig': own.fault.rig,
        'visible': [one._asdict() for one in own.visible],
        'noticed': [one._asdict() for one in own.noticed],
        'position_error': own.position_error, 'force_error': own.force_error,
        'recovered_s': own.recovered_s, 'message': own.message, 'diverged': own.diverged,
    } for own in found]}


def write_page(found: Sequence[FaultEffect], directory: Path) -> list[Path]:
    """Write the page; return its path."""
    page = Page(PAGE, _HEAD)
    page.section('Effects')
    page.table(_rows([own for own in found if not own.fault.rig]))
    for rig, about in ABOUT.items():
        of_rig = [own for own in found if own.fault.rig == rig]
        if of_rig:
            page.section(f'Faults of parts: {rig.replace("_", " ")}')
            page.paragraph(about)
            page.table(_rows(of_rig))
    if messages := _messages(found)[1:]:
        page.section('Messages')
        page.paragraph(_MESSAGES)
        page.table([MESSAGE_HEADER, *messages])
    page.section('The catalogue')
    page.table([LIST_HEADER, *(
        (f'`{fault.name}`', fault.of, f'`{_set(fault)}`', fault.meaning)
        for fault in fault_catalogue().values())])
    return page.write(directory)
