"""The master's side of MIT-mode frames: those it sends, and what it reads of an answer."""

from isa_ros.fieldbus.canopen.mit_frames import MotorAnswer, MotorCommand, Ranges


def special_frame(kind: int) -> bytes:
    """Return the frame of `ENABLE`, `DISABLE` or `SET_ZERO`."""
    return b'\xff' * 7 + bytes([kind])


def command_frame(command: MotorCommand, ranges: Ranges) -> bytes:
    """Return the frame of a command; values beyond their ranges saturate."""
    digits = ''
    for value, (low, high), width in zip(command, ranges, (16, 12, 12, 12, 12), strict=True):
        largest = 2 ** width - 1
        code = round((value - low) / (high - low) * largest) if high > low else 0
        digits += f'{min(max(code, 0), largest):0{width}b}'
    return int(digits, 2).to_bytes(8, 'big')


def answer_of(data: bytes, ranges: Ranges) -> MotorAnswer:
    """Return the answer of a frame of 6 bytes."""
    digits, values = ''.join(f'{byte:08b}' for byte in data[1:]), []
    scales = ranges.position, ranges.velocity, ranges.effort
    for (low, high), begin, end in zip(scales, (0, 16, 28), (16, 28, 40), strict=True):
        largest = 2 ** (end - begin) - 1
        values.append(low + int(digits[begin:end], 2) * (high - low) / largest)
    return MotorAnswer(data[0], *values)
