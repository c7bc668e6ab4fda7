"""Requests to an SDO server, and the values behind it."""

from isa_ros.fieldbus.canopen import sdo
from isa_ros.fieldbus.device.abort import NO_OBJECT, SdoAbort

NUMBER, TEXT = (0x2000, 1), (0x2001, 0)


class SdoServer(sdo.SdoServer):
    """A server of which every answer is one frame or none."""

    def answer(self, data: bytes) -> bytes | None:
        frames = self.answers(data)
        assert len(frames) <= 1
        return frames[0] if frames else None


class Values:
    """A dictionary of a number of 4 bytes and a text."""

    def __init__(self) -> None:
        self.content = {NUMBER: b'\x01\x02\x03\x04', TEXT: b''}

    def read(self, index: int, subindex: int) -> bytes:
        self.size(index, subindex)
        return self.content[index, subindex]

    def write(self, index: int, subindex: int, data: bytes) -> None:
        self.size(index, subindex)
        self.content[index, subindex] = data

    def size(self, index: int, subindex: int) -> int:
        if (index, subindex) not in self.content:
            raise SdoAbort(NO_OBJECT)
        return 4 if (index, subindex) == NUMBER else 0


def request(command: int, key: tuple[int, int], data: bytes = b'') -> bytes:
    index, subindex = key
    return (bytes([command]) + index.to_bytes(2, 'little') + bytes([subindex]) + data).ljust(
        8, b'\0')


def uploaded(server: SdoServer, key: tuple[int, int]) -> bytes:
    """Read an object as a client does; each answer has the toggle bit of its request."""
    answer = server.answer(request(0x40, key))
    if answer[0] & 2:
        return answer[4:8 - (answer[0] >> 2 & 3)]
    size, data, toggle = int.from_bytes(answer[4:], 'little'), b'', 0
    while True:
        answer = server.answer(bytes([0x60 | toggle]) + bytes(7))
        assert answer[0] & 0xF0 == toggle
        data += answer[1:8 - (answer[0] >> 1 & 7)]
        toggle ^= 0x10
        if answer[0] & 1:
            assert len(data) == size
            return data


def downloaded(server: SdoServer, key: tuple[int, int], data: bytes, announced: int) -> bytes:
    """Write an object in segments; return the last answer."""
    answer = server.answer(request(0x21, key, announced.to_bytes(4, 'little')))
    toggle = 0
    while answer[0] != 0x80:
        part, data = data[:7], data[7:]
        command = toggle | 7 - len(part) << 1 | (0 if data else 1)
        answer = server.answer(bytes([command]) + part.ljust(7, b'\0'))
        toggle ^= 0x10
        if not data:
            break
    return answer


def code(answer: bytes | None) -> int:
    assert answer is not None and answer[0] == 0x80
    return int.from_bytes(answer[4:], 'little')
