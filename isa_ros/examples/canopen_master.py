"""
A CANopen master (`canopen`) that brings a leg up, moves it, sees a fault and recovers.

    isa bus describe leg --eds leg.eds
    python -m isa_ros.examples.canopen_master udp_multicast 239.74.163.2 leg_{haa,hfe,kfe}.eds

`docs/fieldbus.md` says how to start the leg on the same bus, as nodes 1, 2 and 3.
"""

from collections.abc import Iterator, Sequence
import math
from queue import Queue
import sys
from typing import Any

import canopen

START, CSP, CYCLES, ANSWER_S = 0x01, 8, 700, 5.0
SWING, PERIOD = 4000, 250           # um | urad, cycles
STATES = {0x40: ('switch on disabled', 0x06), 0x21: ('ready to switch on', 0x07),
          0x23: ('switched on', 0x0F), 0x27: ('operation enabled', 0x0F),
          0x0F: ('fault reaction active', 0x00), 0x08: ('fault', 0x80)}
"""Bits of the status word: the state, and the control word that leads towards operation."""


def drive(node: Any) -> Iterator[None]:
    """Send the RPDOs of a node, cycle by cycle, and print each new state."""
    name, known, since, start = node.sdo[0x1008].raw, '', 0, 0
    for cycle in range(CYCLES):
        state, word = STATES[node.tpdo['Statusword'].raw & 0x6F]
        position = node.tpdo['Position actual value'].raw
        if state != known:
            error = f", error {node.sdo['Error code'].raw:#06x}" if state == 'fault' else ''
            print(f'{cycle:5d} {name}: {state}{error}')
            known, since, start = state, cycle, position
        if state == 'fault' and cycle % 2:  # a reset is a rising edge of its bit
            word = 0x00
        lift = SWING * (1 - math.cos(2 * math.pi * (cycle - since) / PERIOD)) / 2
        node.rpdo['Controlword'].raw, node.rpdo['Modes of operation'].raw = word, CSP
        node.rpdo['Target position'].raw = (
            start + round(lift) if state == 'operation enabled' else position)
        node.rpdo[1].transmit()
        node.rpdo[2].transmit()
        yield


def main(arguments: Sequence[str]) -> None:
    """Run `CYCLES` cycles on nodes 1, 2, ..., each with its EDS, as fast as they answer."""
    interface, channel, *sheets = arguments
    answers: Queue[Any] = Queue()
    with canopen.Network() as network:
        network.connect(interface=interface, channel=channel)
        nodes = [network.add_node(k + 1, sheet) for k, sheet in enumerate(sheets)]
        for node in nodes:
            node.sdo.MAX_RETRIES = 200  # of 0.3 s, while they start
            node.sdo.upload(0x1000, 0)
            node.rpdo.read(from_od=True)
            node.tpdo.read(from_od=True)
            node.tpdo[2].add_callback(answers.put)
        network.nmt.send_command(START)
        cycles = zip(*map(drive, nodes))
        while True:
            network.sync.transmit()
            for _ in nodes:
                answers.get(timeout=ANSWER_S)
            if next(cycles, None) is None:
                break


if __name__ == '__main__':
    main(sys.argv[1:])
