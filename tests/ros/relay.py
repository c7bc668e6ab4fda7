"""
A lossy cable between two interfaces: python -m tests.ros.relay FIRST SECOND LOSS SEED.

Copies every Ethernet frame that arrives at one interface to the other, in both directions, but
for a share LOSS of them. Says so on standard error once it works, and at SIGTERM what it did:
the kernel of a test machine may have no netem.
"""

import random
import selectors
import signal
import socket
import sys

ALL_PROTOCOLS = 0x0003          # ETH_P_ALL of linux/if_ether.h
SOL_PACKET, PACKET_VNET_HDR = 263, 15   # linux/socket.h, linux/if_packet.h
LONGEST_FRAME = 1 << 16
SENT_BY_US = 4                  # PACKET_OUTGOING of linux/if_packet.h
READY = 'relaying'


def open_interface(name: str) -> socket.socket:
    """Return a socket that sends and receives the frames of an interface."""
    port = socket.socket(socket.AF_PACKET, socket.SOCK_RAW, socket.htons(ALL_PROTOCOLS))
    # The header of each frame has the offload request of its sender: the checksum.
    port.setsockopt(SOL_PACKET, PACKET_VNET_HDR, 1)
    port.bind((name, 0))
    port.setblocking(False)
    return port


def relay(first: socket.socket, second: socket.socket, loss: float, seed: int) -> None:
    """Copy frames until SIGTERM."""
    chance, forwarded, dropped = random.Random(seed), 0, 0
    others = {first: second, second: first}
    woken, waking = socket.socketpair()
    waking.setblocking(False)
    signal.set_wakeup_fd(waking.fileno())
    signal.signal(signal.SIGTERM, lambda number, frame: None)
    selector = selectors.DefaultSelector()
    for watched in (first, second, woken):
        selector.register(watched, selectors.EVENT_READ)
    print(READY, file=sys.stderr, flush=True)
    while True:
        for key, _ in selector.select():
            port = key.fileobj
            assert isinstance(port, socket.socket)
            if port is woken:
                print(f'forwarded {forwarded}, dropped {dropped}', file=sys.stderr)
                return
            frame, (_, _, kind, *_) = port.recvfrom(LONGEST_FRAME)
            if kind == SENT_BY_US:
                continue
            if chance.random() < loss:
                dropped += 1
                continue
            forwarded += 1
            others[port].send(frame)


if __name__ == '__main__':
    relay(open_interface(sys.argv[1]), open_interface(sys.argv[2]),
          float(sys.argv[3]), int(sys.argv[4]))
