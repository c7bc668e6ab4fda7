"""The numbers of all rows into the block of messages, bound to their memory; see `packing`."""

from typing import NamedTuple

from isa_ros.core.constants import ATMOSPHERE
from isa_ros.core.kernel import kernel
from isa_ros.core.signals import SAMPLE
from isa_ros.run.link_packing import pack_links, PackedLinks, time_word_of
from isa_ros.run.supply_messages import SIGNALS
from isa_ros.surroundings.supply_sample import SUPPLY_SAMPLE
from msg_adapters.template import FIRST_VALUE
import numpy as np

_SAMPLE, _SUPPLY = tuple(SAMPLE.names or ()), tuple(SUPPLY_SAMPLE.names or ())
PRESSURES = ('pressure_a', 'pressure_b', 'cushion_pressure')
"""Fields of a `SAMPLE` that are published absolute: gauge plus the atmosphere."""
APPLIED = ('is_enabled', 'position', 'velocity', 'effort', 'stiffness', 'damping', 'mode',
           'reference', 'kinds')
"""Fields of an applied `COMMAND` that are published, behind the pressures."""
_PRESSURE_A, _PRESSURE_B, _CUSHION = (_SAMPLE.index(name) for name in PRESSURES)
_GAS, _OIL = (_SUPPLY.index(name) for name in SIGNALS[2:])


class PackedBlock(NamedTuple):
    """Of a `msg_adapters.template.Template`."""

    block: np.ndarray
    """Words of the messages."""
    places: np.ndarray
    sources: np.ndarray


class Packing(NamedTuple):
    """Memory of `pack`."""

    times: np.ndarray
    """End and begin of the tick, and the time of stamps at t = 0, ns, int64, (3,)."""
    samples: np.ndarray
    """Floats of `SAMPLE`, (n, fields)."""
    applied: np.ndarray
    """`COMMAND`, (n,)."""
    supplies: np.ndarray
    """Floats of `SUPPLY_SAMPLE`, (m, fields)."""
    bodies: tuple[np.ndarray, ...]
    """Floats of the sample of each, one or more."""
    links: PackedLinks
    words: np.ndarray
    """Of the template, (w,)."""
    values: np.ndarray
    """The same memory as floats."""
    target: PackedBlock


@kernel
def pack(own):
    """Write the numbers of all rows into the block of a template; return 0."""
    words, values = own.words, own.values
    end_ns, begin_ns, start_ns = own.times[0], own.times[1], own.times[2]
    words[0], words[1] = time_word_of(start_ns + end_ns), time_word_of(start_ns + begin_ns)
    at = FIRST_VALUE
    for n in range(len(own.samples)):
        sample, command = own.samples[n], own.applied[n]
        for j in range(len(sample)):
            values[at] = sample[j]
            at += 1
        values[at] = sample[_PRESSURE_A] + ATMOSPHERE
        values[at + 1] = sample[_PRESSURE_B] + ATMOSPHERE
        values[at + 2] = sample[_CUSHION] + ATMOSPHERE
        values[at + 3], values[at + 4] = float(command.is_enabled), command.position
        values[at + 5], values[at + 6] = command.velocity, command.effort
        values[at + 7], values[at + 8] = command.stiffness, command.damping
        values[at + 9], values[at + 10] = float(command.mode), command.reference
        values[at + 11] = float(command.kinds)
        at += 12
    for m in range(len(own.supplies)):
        supply = own.supplies[m]
        values[at], values[at + 1] = supply[0] + ATMOSPHERE, supply[1] + ATMOSPHERE
        values[at + 2], values[at + 3] = supply[_GAS], supply[_OIL]
        at += 4
    for body in own.bodies:
        for j in range(len(body)):
            values[at] = body[j]
            at += 1
    pack_links(end_ns, begin_ns, start_ns, own.links, own.samples, own.applied, words, values)
    for k in range(len(own.target.places)):
        own.target.block[own.target.places[k]] = words[own.target.sources[k]]
    return 0
