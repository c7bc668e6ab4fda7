"""Bytes of true messages, altered."""

import random

INTERESTING = (0, 1, 2, 4, 7, 8, 16, 99, 255, 256, 10**6, 2**31 - 1, 2**32 - 1)
NOT_FINITE = (b'\x00\x00\x00\x00\x00\x00\xf8\x7f', b'\x00\x00\x00\x00\x00\x00\xf0\xff')


def altered(data: bytes, dice: random.Random) -> bytes:
    """Return bytes with one to four places overwritten, or a piece cut off or put in."""
    found = bytearray(data)
    for _ in range(dice.choice((1, 1, 2, 4))):
        act, at = dice.randrange(8), dice.randrange(len(found) + 1)
        if act < 2:
            found[at:at + 1] = bytes([dice.randrange(256)])
        elif act < 5:
            at -= at % 4
            found[at:at + 4] = dice.choice(INTERESTING).to_bytes(4, 'little')
        elif act == 5:
            at -= at % 8
            found[at:at + 8] = dice.choice(NOT_FINITE)
        elif act == 6:
            del found[at:at + dice.choice((1, 4, 8, len(found)))]
        else:
            found[at:at] = dice.randbytes(dice.choice((1, 4, 8, 100)))
    return bytes(found)
