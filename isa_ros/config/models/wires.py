"""
The wires that links run on: what a cycle of frames takes of them.

All actuators of a run with the same kind of link are on one wire, and all of them in each of its
cycles. Its frames must have left before the next cycle begins.
"""

from collections.abc import Mapping
import math

from isa_ros.actuator.link import LinkSheet, NONE
from isa_ros.config.models.catalogue import wire_section
from isa_ros.config.text.parameter_sets import build
from isa_ros.config.text.sections import Place, Section
from isa_ros.core.frozen import frozen
from isa_ros.core.parameter import parameter, Parameters
from isa_ros.errors import ConfigError

_BITS_PER_MS = 1000.0   # of 1 Mbit/s


@frozen(kw_only=True)
class Wire(Parameters):
    """Rate and frame sizes of one kind of wire."""

    bit_rate_mbit: float = parameter('bit rate', 'Mbit/s', gt=0.0, le=1e4)
    actuator_bits: float = parameter(
        'of an actuator in a cycle, both ways, with frames and stuffing of its own', 'bit',
        gt=0.0, le=1e5)
    frame_bits: float = parameter(
        'of a frame that actuators share, besides their own', 'bit', ge=0.0, le=1e5)
    frame_capacity_bits: float = parameter(
        "of actuators' data in such a frame; 0: no frame is shared", 'bit', ge=0.0, le=1e6)

    def bits(self, n_actuators: int) -> float:
        """Return the bits of a cycle with ``n_actuators``."""
        own = n_actuators * self.actuator_bits
        return own + self.frames(n_actuators) * self.frame_bits

    def frames(self, n_actuators: int) -> int:
        """Return the shared frames of a cycle with ``n_actuators``."""
        if not self.frame_capacity_bits:
            return 0
        return math.ceil(n_actuators * self.actuator_bits / self.frame_capacity_bits)


def wire(kind: str) -> tuple[Wire, Section]:
    """Return the wire of a kind of link, and the section it was built from."""
    section, place = wire_section(kind, 'link.kind')
    return build(Wire, section, place), section


def refuse_overfull(links: Mapping[str, LinkSheet], place: Place) -> None:
    """
    Refuse links whose frames do not fit on their wire; ``links`` are those of all actuators.

    Raises
    ------
    ConfigError
        Actuators of one wire have different cycles, or a cycle is too short for its frames; the
        message has the arithmetic.

    """
    for kind in dict.fromkeys(link.kind for link in links.values() if link.kind != NONE):
        on_wire = {name: link for name, link in links.items() if link.kind == kind}
        first, *others = on_wire
        cycle_ms = on_wire[first].cycle_ms
        for other in others:
            if on_wire[other].cycle_ms != cycle_ms:
                raise ConfigError(
                    f'{place}: link.cycle_ms = {cycle_ms:g} ms of {first} and '
                    f'{on_wire[other].cycle_ms:g} ms of {other}, must be equal: one {kind} wire '
                    'has one cycle')
        _refuse_short_cycle(kind, cycle_ms, list(on_wire), place)


def _refuse_short_cycle(kind: str, cycle_ms: float, names: list[str], place: Place) -> None:
    own, n = wire(kind)[0], len(names)
    rate = own.bit_rate_mbit * _BITS_PER_MS
    needed, available = own.bits(n), rate * cycle_ms
    if needed <= available:
        return
    shared = f' + {own.frames(n)} x {own.frame_bits:g}' if own.frame_bits else ''
    raise ConfigError(
        f'{place}: link.cycle_ms = {cycle_ms:g} ms, must be >= {needed / rate:g} ms: '
        f'{n} actuators ({", ".join(names)}) need {n} x {own.actuator_bits:g}{shared} = '
        f'{needed:g} bit, {kind} at {own.bit_rate_mbit:g} Mbit/s carries {available:g} bit')
