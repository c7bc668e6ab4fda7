"""
Write the tables of docs/canopen.md from the object tables of the leg.

    python scripts/write_canopen.py
"""

from collections.abc import Iterator, Sequence
from pathlib import Path

import isa_ros
from isa_ros.fieldbus.canopen.capacity import cycle_bits, CyclicFrame, frame_bits
from isa_ros.fieldbus.canopen.line import CanopenLine, default_bitrate
from isa_ros.fieldbus.canopen.mit_frames import ANSWER_BYTES, COMMAND_BYTES
from isa_ros.fieldbus.device.bus_device import BusDevice, RECEIVE_ASSIGNMENT, TRANSMIT_ASSIGNMENT
from isa_ros.fieldbus.device.can_identifiers import SYNC
from isa_ros.fieldbus.device.devices import devices_of
from isa_ros.fieldbus.device.manufacturer_area import MIT_RANGES
from isa_ros.fieldbus.serial.frame import STATUS
from isa_ros.fieldbus.serial.line import parts
from isa_ros.text.marked import with_parts
from isa_ros.text.table import markdown

PAGE = Path(__file__).resolve().parents[1] / 'docs' / 'canopen.md'
FIRST_NODE = 1
_MIT_BITS = (16, 12, 12, 12, 12)


def frames(devices: Sequence[BusDevice], step_ns: int) -> list[str]:
    """Return the frames of a cycle of the first actuator."""
    node = CanopenLine(devices[:1], step_ns, FIRST_NODE, default_bitrate()).nodes[0]
    rows = [['frame', 'COB-ID', 'bytes', 'bit, at most', 'content by default']]
    rows.append(['SYNC', f'0x{SYNC:03X}', '0', str(frame_bits(CyclicFrame(SYNC, 0))), '-'])
    for pdo in node.pdos():
        frame = pdo.cyclic_frame(node.communication, node.device)
        is_receive = pdo.mapping < 0x1A00
        number = pdo.mapping & 0xFF
        base = (0x200 if is_receive else 0x180) + 0x100 * number
        rows.append([
            f'{"RPDO" if is_receive else "TPDO"} {number + 1}{"" if frame else ", off"}',
            f'0x{base:03X} + node', str(node.device.size(pdo.mapping)),
            str(frame_bits(CyclicFrame(base + FIRST_NODE, node.device.size(pdo.mapping)))),
            ', '.join(name for _, name, _ in _mapped(node.device, pdo.mapping))])
    return markdown(rows)


def capacity() -> list[str]:
    """Return how many actuators fit, by frames and tick."""
    run = isa_ros.load('leg').configuration
    rates = {'1 ms': 1e-3, '2 ms': 2e-3, '4 ms': 4e-3}
    rows = [['frames of each actuator', 'bit', *(f'in {name}' for name in rates)]]
    for words, profile in (('CiA 402', 'cia402'), ('CiA 408', 'cia408')):
        node = CanopenLine(devices_of(run, profile)[:1], run.step_ns, FIRST_NODE,
                           default_bitrate()).nodes[0]
        rows.append(_fitting(words, node.cyclic_frames(), [CyclicFrame(SYNC, 0)],
                             list(rates.values())))
    mit = [CyclicFrame(FIRST_NODE, COMMAND_BYTES), CyclicFrame(0, ANSWER_BYTES)]
    rows.append(_fitting('MIT', mit, [], list(rates.values())))
    return markdown(rows)


def _fitting(words: str, own: list[CyclicFrame], shared: list[CyclicFrame],
             ticks: list[float]) -> list[str]:
    """Return a row; nodes 1, 2, ... differ in their stuff bits."""
    fitting = []
    for tick in ticks:
        available, n = default_bitrate() * tick, 0
        needed = cycle_bits(shared)
        while True:
            needed += cycle_bits(
                frame._replace(identifier=frame.identifier + n if frame.identifier else 0)
                for frame in own)
            if needed > available:
                break
            n += 1
        fitting.append(str(n))
    return [words, str(cycle_bits(own)), *fitting]


def ranges(devices: Sequence[BusDevice]) -> list[str]:
    """Return the ranges of MIT frames at power-on, and the size of a step."""
    table = devices[0].table
    names = [table.entry(MIT_RANGES, k).name.lower() for k in range(1, 6)]
    rows = [['actuator', *(f'0x{MIT_RANGES:04X}:{k} {name}' for k, name in enumerate(names, 1))]]
    for device in devices:
        cells = []
        for k, bits in enumerate(_MIT_BITS, 1):
            entry = device.table.entry(MIT_RANGES, k)
            is_signed = k not in (3, 4)
            high = float(entry.default)
            step = (2.0 if is_signed else 1.0) * high / ((1 << bits) - 1)
            cells.append(f'{"+-" if is_signed else "0 to "}{high:.4g} {entry.unit}, '
                         f'step {step:.3g}')
        rows.append([device.name, *cells])
    return markdown(rows)


def request(devices: Sequence[BusDevice]) -> list[str]:
    """Return the content of a request of process data of one actuator."""
    return _content(devices, RECEIVE_ASSIGNMENT, 0, [])


def answer(devices: Sequence[BusDevice]) -> list[str]:
    """Return the content of an answer of process data of one actuator."""
    head = [['0', '4', '-', 'abort code, 0: done', 'UNSIGNED32', '-'],
            ['4', '2', '-', 'requests discarded so far', 'UNSIGNED16', '-']]
    return _content(devices, TRANSMIT_ASSIGNMENT, STATUS.size, head)


def _content(devices: Sequence[BusDevice], assignment: int, offset: int,
             head: list[list[str]]) -> list[str]:
    rows = [['offset', 'bytes', 'object', 'name', 'type', 'SI per count'], *head]
    for part in parts(devices[-1:], assignment):
        at = offset + part.offset
        for place, name, entry_bytes in _mapped(part.device, part.pdo):
            if place is None:
                rows.append([str(at), str(entry_bytes), '-', 'unused', '-', '-'])
            else:
                entry = part.device.table.entry(*place)
                where = f'0x{place[0]:04X}' + (f':{place[1]}' if place[1] else '')
                scale = f'{entry.scale:g} {entry.unit}' if entry.unit else '-'
                rows.append([str(at), str(entry_bytes), where, name, entry.data_type.name, scale])
            at += entry_bytes
    return markdown(rows)


def _mapped(
        device: BusDevice, pdo: int) -> Iterator[tuple[tuple[int, int] | None, str, int]]:
    """Iterate over key, name and bytes of what a PDO holds; no key: unused bytes."""
    count, *words = device.table.at(pdo).entries
    for word in [int(entry.default) for entry in words[:int(count.default)]]:
        key = word >> 16, word >> 8 & 0xFF
        size = (word & 0xFF) // 8
        yield (key, device.table.entry(*key).name, size) if key[0] else (None, 'unused', size)


def written(page: str) -> str:
    """Return the page with the tables of today."""
    run = isa_ros.load('leg').configuration
    devices = devices_of(run)
    return with_parts(page, {
        'frames': frames(devices, run.step_ns), 'capacity': capacity(),
        'ranges': ranges(devices), 'request': request(devices), 'answer': answer(devices)})


if __name__ == '__main__':
    PAGE.write_text(written(PAGE.read_text(encoding='utf-8')), encoding='utf-8')
