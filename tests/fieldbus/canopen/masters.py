"""
Masters that know nothing of the package, each with a server of its own in this network namespace.

``python -m tests.fieldbus.canopen.masters NAME BUS FOLDER STALL`` prints what the master saw, as
JSON.
"""

from collections.abc import Iterator
from contextlib import contextmanager
import json
from pathlib import Path
import random
import struct
import subprocess
import sys
import threading
import time
from typing import Any

import can
import canopen
from canopen.profiles.p402 import BaseNode402

GROUP, CAN = '239.74.163.2', 'can0'
BUSES = {
    'udp_multicast': (GROUP, ['ip link set lo up multicast on',
                              f'ip route add {GROUP} dev lo']),
    'socketcan': (CAN, [f'ip link add {CAN} type vcan', f'ip link set {CAN} up'])}
"""Channel of each interface, and the commands that make it."""
SYNC_PERIOD = 10e-3     # s, of the library's thread; above what a tick takes on loaded cores
DEADLINE = 30.0         # s, for what takes milliseconds


class PatientNode(BaseNode402):     # type: ignore[misc]
    """The library's master with time for loaded cores."""

    TIMEOUT_RESET_FAULT = 1.0   # s, which it always waits
    TIMEOUT_SWITCH_OP_MODE = TIMEOUT_SWITCH_STATE_FINAL = DEADLINE
    TIMEOUT_SWITCH_STATE_SINGLE = TIMEOUT_CHECK_TPDO = DEADLINE


Bus = dict[str, str]
"""Interface and channel of python-can."""


@contextmanager
def server(at: Bus, *arguments: str) -> Iterator[dict[str, Any]]:
    """Run a server; at the end the dictionary has its ticks and digest."""
    command = [sys.executable, '-m', 'tests.fieldbus.canopen.serve', *arguments,
               '--interface', at['interface'], '--channel', at['channel']]
    result: dict[str, Any] = {}
    child = subprocess.Popen(
        command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    try:
        assert child.stdout is not None and child.stdout.readline() == 'ready\n'
        yield result
        output, _ = child.communicate(timeout=DEADLINE)
        result |= json.loads(output)
    finally:
        if child.poll() is None:
            child.kill()
            child.wait()


def base_node_402(at: Bus, folder: Path, stall: float) -> dict[str, Any]:
    """Drive a real actuator by `canopen` and its EDS, through a fault and back."""
    seen: dict[str, Any] = {}
    eds = folder / 'actuator.eds'
    with server(at, '--config', 'rig_linear', '--eds', str(eds)) as result:
        network = canopen.Network()
        network.connect(**at)
        node = PatientNode(1, str(eds))
        network.add_node(node)
        try:
            _bring_up(network, node)
            seen |= {'name': node.sdo[0x1008].raw, 'enabled': node.state}
            _fail(node, seen)
            node.sdo[0x6065].raw = 0xFFFFFFFF   # not watched
            node.reset_from_fault()
            seen['after'] = [node.state, node.sdo[0x603F].raw, node.sdo[0x1001].raw]
            node.state = 'SWITCH ON DISABLED'
            seen['end'] = node.state
            seen['heartbeat'] = _heartbeat(node)
        finally:
            node.rpdo[1].stop()
            network.sync.stop()
            network.disconnect()
    return seen | result


def _bring_up(network: canopen.Network, node: BaseNode402) -> None:
    booted = threading.Event()      # the library's own wait misses a message that is early
    node.nmt.add_heartbeat_callback(lambda state: booted.set() if state == 0 else None)
    node.nmt.state = 'RESET COMMUNICATION'
    assert booted.wait(DEADLINE)
    node.setup_402_state_machine()
    node.nmt.state = 'OPERATIONAL'
    network.sync.start(SYNC_PERIOD)
    node.rpdo[1].start(SYNC_PERIOD)     # the library does not send a synchronous RPDO by itself
    node.op_mode = 'CYCLIC SYNCHRONOUS POSITION'
    node.state = 'OPERATION ENABLED'


def _fail(node: BaseNode402, seen: dict[str, Any]) -> None:
    """Cause a following error: a step of 20 mm, watched to 0.1 mm."""
    node.sdo[0x6065].raw = 100
    node.sdo[0x6066].raw = 2
    errors: list[int] = []
    node.emcy.add_callback(lambda error: errors.append(error.code))
    node.rpdo[2][0x607A].raw = node.sdo[0x6064].raw + 20_000
    node.rpdo[2].transmit()
    limit = time.monotonic() + DEADLINE
    while node.state != 'FAULT' and time.monotonic() < limit:
        node.check_statusword()
    seen |= {'emergencies': errors, 'fault': node.state, 'code': node.sdo[0x603F].raw,
             'register': node.sdo[0x1001].raw, 'history': node.sdo[0x1003][1].raw & 0xFFFF}


def _heartbeat(node: BaseNode402) -> str:
    node.sdo[0x1017].raw = 10
    state: str = node.nmt.wait_for_heartbeat(DEADLINE)
    return state


def one_thread(at: Bus, folder: Path, stall: float) -> dict[str, Any]:
    """Command a sine of force, RPDOs and then SYNC, the next cycle after the last TPDO."""
    draw, seen = random.Random(3), {'lost': 0}
    with server(at, '--config', 'rig_linear') as result:
        with can.Bus(**at) as bus:
            send(bus, 0x000, b'\x82\x00')
            while receive(bus) != (0x701, b'\0'):
                pass
            send(bus, 0x000, b'\x01\x00')
            status = 0
            for k in range(400):
                if stall and draw.random() < 0.02:
                    time.sleep(stall * draw.random())
                word = {0x40: 6, 0x21: 7, 0x23: 15, 0x27: 15, 0x08: 0x80}.get(status & 0x6F, 6)
                torque = round(100 * ((k // 50) % 2))
                send(bus, 0x201, struct.pack('<Hbh', word, 10, torque))
                send(bus, 0x301, struct.pack('<ii', 0, 0))
                send(bus, 0x080, b'')
                while (frame := receive(bus)) is not None and frame[0] != 0x281:
                    if frame[0] == 0x181:
                        status, _, _ = struct.unpack('<Hbh', frame[1])
                seen['lost'] += frame is None
            seen['status'] = status & 0x6F
    return seen | result


def send(bus: can.BusABC, identifier: int, data: bytes) -> None:
    """Send a frame."""
    bus.send(can.Message(arbitration_id=identifier, data=data, is_extended_id=False))


def receive(bus: can.BusABC) -> tuple[int, bytes] | None:
    """Return the next frame, None if there is none for long."""
    message = bus.recv(DEADLINE)
    return None if message is None else (message.arbitration_id, bytes(message.data))


MASTERS = {'base_node_402': base_node_402, 'one_thread': one_thread}


def main() -> None:
    """Run the named master on a new bus in this namespace."""
    name, interface, folder, stall = sys.argv[1:]
    channel, commands = BUSES[interface]
    for command in commands:
        subprocess.run(command.split(), check=True)
    at = {'interface': interface, 'channel': channel}
    print(json.dumps(MASTERS[name](at, Path(folder), float(stall))))


if __name__ == '__main__':
    main()
