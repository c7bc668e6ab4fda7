"""
An EtherCAT master (pysoem) that brings a leg up, moves it, sees a fault and recovers.

    python -m isa_ros.examples.ethercat_master ecm

`docs/fieldbus.md` says how to start the leg on the other end of the interface.
"""

from collections.abc import Iterator, Sequence
import math
import struct
import sys
from threading import Event
from typing import Any

import pysoem

OUT = struct.Struct('<Hbxiiihhff')  # 0x1610: control word, mode, targets, offsets, gains
IN = struct.Struct('<HbxiihHfff')   # 0x1A10: status word, mode, position, speed, torque, error, ..
CSP, CYCLES, RECEIVE_US = 8, 1400, 5_000_000
SWING, PERIOD = 4000, 500           # um | urad, cycles
STATES = {0x40: ('switch on disabled', 0x06), 0x21: ('ready to switch on', 0x07),
          0x23: ('switched on', 0x0F), 0x27: ('operation enabled', 0x0F),
          0x0F: ('fault reaction active', 0x00), 0x08: ('fault', 0x80)}
"""Bits of the status word: the state, and the control word that leads towards operation."""


def drive(slave: Any, name: str) -> Iterator[None]:
    """Write the outputs of a slave, cycle by cycle, and print each new state."""
    known = since = start = 0
    for cycle in range(CYCLES):
        status, _, position, _, _, error, *_ = IN.unpack(slave.input)
        state, word = STATES[status & 0x6F]
        if status & 0x6F != known:
            print(f'{cycle:5d} {name}: {state}{f", error {error:#06x}" if error else ""}')
            known, since, start = status & 0x6F, cycle, position
        if state == 'fault' and cycle % 2:  # a reset is a rising edge of its bit
            word = 0x00
        lift = SWING * (1 - math.cos(2 * math.pi * (cycle - since) / PERIOD)) / 2
        target = start + round(lift) if state == 'operation enabled' else position
        slave.output = OUT.pack(word, CSP, target, 0, 0, 0, 0, math.nan, math.nan)
        yield


def exchange(master: Any) -> None:
    """Exchange process data with all slaves, once."""
    master.send_processdata()
    if master.receive_processdata(RECEIVE_US) != master.expected_wkc:
        raise SystemExit('a frame was lost, or a slave has left')


def main(arguments: Sequence[str]) -> None:
    """Run `CYCLES` cycles on the slaves of an interface, as fast as they answer."""
    master = pysoem.Master()
    master.open(arguments[0])
    if not any(master.config_init() > 0 or Event().wait(1) for _ in range(60)):     # s: they start
        raise SystemExit(f'no slaves on {arguments[0]}')
    master.config_map()
    names = [slave.sdo_read(0x1008, 0).decode() for slave in master.slaves]
    master.state = pysoem.OP_STATE
    master.write_state()
    while master.state_check(pysoem.OP_STATE, 2000) != pysoem.OP_STATE:
        exchange(master)
    exchange(master)    # the first cycle of `drive` needs inputs, however long this took
    for _ in zip(*map(drive, master.slaves, names)):
        exchange(master)
    master.close()


if __name__ == '__main__':
    main(sys.argv[1:])
