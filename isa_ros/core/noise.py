"""
Noise without a state: a number of a hash at a counter, as in `Philox4x32-10`.

Salmon, Moraes, Dror, Shaw: Parallel random numbers: as easy as 1, 2, 3 (SC 2011). Key and
counter determine the number: who computes it, in which order and how often makes no difference,
and a saved state has nothing to hold. A product of two words of 32 bits fits into 64, so that
kernels and Python give the same bits.

The key is that of one source of noise in one run: the seed of the run, and the name of an
actuator or of an inertial unit. The counter is the step of the plant and the channel.
"""

import hashlib
import math
import operator
from typing import Any

from isa_ros.core.elementary import cos, log
from isa_ros.core.kernel import kernel
from isa_ros.core.suggest import shortened
from isa_ros.errors import ConfigError
import numpy as np

LARGEST_SEED = 2**63 - 1
"""A seed is an integer from 0 on; ROS parameters have 64 bits with a sign."""

_ROUNDS = 10
_M_0, _M_1 = np.uint64(0xD2511F53), np.uint64(0xCD9E8D57)   # multipliers of the paper
_W_0, _W_1 = np.uint64(0x9E3779B9), np.uint64(0xBB67AE85)   # its increments of the key
_WORD, _HALF = np.uint64(0xFFFFFFFF), np.uint64(32)
_HIGH, _LOW = np.uint64(21), np.uint64(11)                  # 53 bits: 32 of one word, 21
_ULP = 1.0 / 9007199254740992.0                             # 2^-53


def seed_of(value: Any, where: str) -> int:
    """
    Return a value as a seed; ``where`` names it in the message.

    Raises
    ------
    ConfigError
        It is not a whole number from 0 to `LARGEST_SEED`.

    """
    try:
        seed = -1 if isinstance(value, bool) else operator.index(value)
    except TypeError:
        seed = -1
    if not 0 <= seed <= LARGEST_SEED:
        raise ConfigError(
            f'{where} = {shortened(repr(value))}, must be a whole number >= 0 and '
            f'<= {LARGEST_SEED}')
    return seed


def noise_key(seed: int, name: str) -> int:
    """Return the key of a source of noise, 64 bits; ``name`` is its name in the run."""
    digest = hashlib.sha256(f'{seed}/{name}'.encode()).digest()
    return int.from_bytes(digest[:8], 'little')


@kernel
def philox(c_0, c_1, c_2, c_3, k_0, k_1):
    """Return the four words of a counter under a key of two words, all ``uint64`` < 2^32."""
    for _ in range(_ROUNDS):
        first, second = _M_0 * c_0, _M_1 * c_2
        c_0, c_1, c_2, c_3 = (
            (second >> _HALF) ^ c_1 ^ k_0, second & _WORD, (first >> _HALF) ^ c_3 ^ k_1,
            first & _WORD)
        k_0, k_1 = (k_0 + _W_0) & _WORD, (k_1 + _W_1) & _WORD
    return c_0, c_1, c_2, c_3


@kernel
def uniforms(key, step, channel):
    """
    Return two independent numbers, uniform in [0, 1), of a step >= 0 and a channel >= 0.

    Multiples of 2^-53.
    """
    at, own = np.uint64(step), np.uint64(key)
    a, b, c, d = philox(at & _WORD, at >> _HALF, np.uint64(channel), np.uint64(0),
                        own & _WORD, own >> _HALF)
    return (float((a << _HIGH) | (b >> _LOW)) * _ULP, float((c << _HIGH) | (d >> _LOW)) * _ULP)


@kernel
def normal(key, step, channel):
    """
    Return a number of the standard normal distribution, by Box and Muller.

    The root is of 1 - u > 0, so that the largest number is sqrt(2 ln 2^53) = 8.6.
    """
    u, v = uniforms(key, step, channel)
    return math.sqrt(-2.0 * log(1.0 - u)) * cos(2.0 * math.pi * v)
