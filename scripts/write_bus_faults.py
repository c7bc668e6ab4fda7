"""
Write the table of docs/fieldbus.md: the faults of the device as a master sees them.

    python scripts/write_bus_faults.py

The master is that of `isa_ros/examples/ethercat_master.py` without the wire: its process data go
to the device of the rig of `isa faults` in this process, cycle by cycle.
"""

from collections.abc import Iterator
import math
from pathlib import Path
import re
import struct
from typing import NamedTuple

from isa_ros.analysis.faults.measure import BEGIN_S, END_S, STEP_S
from isa_ros.analysis.faults.rigs import CONFIG, DURATION_S
from isa_ros.config.models.fault_catalogue import ACTUATOR, common_faults, NamedFault
from isa_ros.core.signals import COMMAND
from isa_ros.fieldbus.device.devices import devices_of
from isa_ros.fieldbus.session import commanded_by_bus
from isa_ros.scenario.scenario import idle
from isa_ros.scripting.run import load
from isa_ros.simulation import Simulation
import numpy as np

PAGE = Path(__file__).resolve().parents[1] / 'docs' / 'fieldbus.md'
MARKER = 'device faults'
OUT, IN = struct.Struct('<Hbxiiihhff'), struct.Struct('<HbxiihHfff')
RECEIVE, TRANSMIT = 0x1610, 0x1A10
IMPEDANCE, STIFFNESS, DAMPING = -1, 1.0e5, 4000.0
AMPLITUDE, FREQUENCY_HZ = 20_000.0, 2.0     # um
STATE, WARNING = 0x6F, 1 << 7
ENABLED, FAULT = 0x27, 0x08
STATES = {0x40: ('switch on disabled', 0x06), 0x21: ('ready to switch on', 0x07),
          0x23: ('switched on', 0x0F), ENABLED: ('operation enabled', 0x0F),
          0x0F: ('fault reaction active', 0x00), FAULT: ('fault', 0x80), 0x00: ('not ready', 0x00)}
"""Bits of the status word: the state, and the control word that leads towards operation."""


class MasterValues(NamedTuple):
    """The values that the master receives in one cycle."""

    status: int
    error: int
    emergencies: tuple[int, ...]


def seen(fault: NamedFault | None) -> list[MasterValues]:
    """Return what the master sees of a run, in every cycle."""
    run = commanded_by_bus(load(CONFIG).configuration)
    scenario = idle(run, DURATION_S)
    if fault is not None:
        target = run.actuators[0].name if fault.of == ACTUATOR else run.supplies[0].name
        scenario = scenario.with_faults([
            {'t_s': BEGIN_S, fault.of: target, 'fault': fault.name, 'until_s': END_S}])
    simulation, (device,) = Simulation(scenario), devices_of(run)
    rows, found, output = np.zeros(1, COMMAND), [], bytes(OUT.size)
    device.begin_operation()
    start = None
    for cycle in range(round(DURATION_S / STEP_S)):
        device.take_sample(simulation.group.observed[0], cycle)
        status, _, position, _, _, error, *_ = IN.unpack(device.transmit(TRANSMIT))
        device.receive(RECEIVE, output)
        found.append(MasterValues(status, error, tuple(one.code for one in device.emergencies())))
        start = position if start is None else start
        output = answer(cycle + 1, status, start)
        rows['kinds'] = 0
        device.fill_command(rows[0])
        simulation.step(rows)
    return found


def answer(cycle: int, status: int, start: int) -> bytes:
    """Return the process data of the next cycle; a reset of a fault is a rising edge."""
    state, word = STATES[status & STATE]
    if state == 'fault' and cycle % 2:
        word = 0x00
    target = start + round(AMPLITUDE * math.sin(2.0 * math.pi * FREQUENCY_HZ * cycle * STEP_S))
    return OUT.pack(word, IMPEDANCE, target, 0, 0, 0, 0, STIFFNESS, DAMPING)


def table() -> str:
    """Return the table, without the faults that a master does not see."""
    sound = seen(None)
    assert not any(one.error or one.emergencies for one in sound), 'the sound run has no errors'
    rows = [('fault', 'status word, after ms', '0x603F', 'EMCY, after ms',
             'enabled again, ms after the end'), ('---',) * 5]
    unseen = []
    for fault in common_faults().values():
        if any(key.startswith('link.') for key in fault.values):
            continue    # refused under `isa bus`
        own = seen(fault)
        row = row_of(own, sound)
        if row is None:
            unseen.append(f'`{fault.name}`')
        else:
            rows.append((f'`{fault.name}`', *row))
    text = '\n'.join(f'| {" | ".join(row)} |' for row in rows)
    return f'{text}\n\nNot seen in the status word: {", ".join(unseen)}.'


def row_of(own: list[MasterValues], sound: list[MasterValues]) -> tuple[str, str, str, str] | None:
    """Return the cells of a fault; None if status word and error do not show it."""
    begin, end = round(BEGIN_S / STEP_S), round(END_S / STEP_S)
    changes = list(changes_of(own, sound, begin))
    errors = list(dict.fromkeys(f'0x{one.error:04X}' for one in own if one.error))
    messages = list(messages_of(own, begin))
    if not changes and not messages:
        return None
    stopped = [cycle for cycle, one in enumerate(own)
               if cycle >= begin and one.status & STATE != ENABLED]
    again = 'stays enabled'
    if stopped:
        again = 'not in this run' if stopped[-1] == len(own) - 1 else str(
            max(0, stopped[-1] + 1 - end))
    return ', '.join(changes), ', '.join(errors) or '0', ', '.join(messages) or 'none', again


def messages_of(own: list[MasterValues], begin: int) -> Iterator[str]:
    """Yield the code of each emergency message, with the time of the first and their number."""
    times: dict[int, list[int]] = {}
    for cycle, one in enumerate(own):
        for code in one.emergencies:
            times.setdefault(code, []).append(cycle - begin)
    for code, at in times.items():
        yield f'0x{code:04X} {at[0]}' + (f' ({len(at)} times)' if len(at) > 1 else '')


def changes_of(own: list[MasterValues], sound: list[MasterValues], begin: int) -> Iterator[str]:
    """Yield the first warning, and the first fault reaction and fault, with their times."""
    for words, is_seen in (
            ('warning (bit 7)', lambda one: one.status & WARNING),
            ('fault reaction active', lambda one: one.status & STATE == 0x0F),
            ('fault', lambda one: one.status & STATE == FAULT)):
        for cycle, (one, other) in enumerate(zip(own, sound)):
            if is_seen(one) and not is_seen(other):
                yield f'{words} {cycle - begin}'
                break


def page(text: str) -> str:
    """Return the text of the page with the table of today."""
    text, n = re.subn(
        rf'(<!-- {MARKER} -->\n).*?(<!-- end -->)',
        lambda found: f'{found[1]}{table()}\n{found[2]}', text, flags=re.DOTALL)
    assert n == 1, f'{PAGE} has one table <!-- {MARKER} -->'
    return text


def main() -> None:
    """Write the page."""
    PAGE.write_text(page(PAGE.read_text(encoding='utf-8')), encoding='utf-8')
    print(PAGE)


if __name__ == '__main__':
    main()
