"""A supply's part of a tick, bound to its memory: before its actuators, and after them."""

from typing import NamedTuple

from isa_ros.core.kernel import kernel, kernel_function
from isa_ros.core.units import MPA
from isa_ros.surroundings.accumulator import accumulator_node, supply_advance
from isa_ros.surroundings.dump import DUMP, opened_after
from isa_ros.surroundings.return_line import return_advance, SUPPLY_STEP
from isa_ros.surroundings.supply_port import fill_feeds
import numpy as np

IDEAL = np.dtype([
    ('pressure_mpa', 'f8'), ('return_mpa', 'f8'),
    ('dump_valve', DUMP)])      # acts over a tick
"""An ideal supply."""


class SupplyRecords(NamedTuple):
    """Constants of one supply, (1,) each; no row of what it has not."""

    ideal: np.ndarray
    """`IDEAL`."""
    supply: np.ndarray
    """`SUPPLY` of a pump with accumulator."""
    line: np.ndarray
    """`RETURN_LINE` with a volume."""


class SupplyPressures(NamedTuple):
    """Memory of `fill_pressures`."""

    state: np.ndarray
    """`SUPPLY_SAMPLE`, (1,)."""
    rows: np.ndarray
    """Of its actuators, int64."""
    ports: np.ndarray
    """`LOAD_PORT` of all actuators."""


class SupplyFeeds(NamedTuple):
    """Memory of `fill_line`."""

    state: np.ndarray
    """`SUPPLY_SAMPLE`, (1,)."""
    supply: np.ndarray
    """`SUPPLY`, (1,)."""
    rows: np.ndarray
    """Of its actuators, int64."""
    answers: np.ndarray
    """`SUPPLY_REPLY` of all actuators at the end of the last tick."""
    feeds: np.ndarray
    """`SUPPLY_PORT` of all actuators."""


class SupplyTick(NamedTuple):
    """Memory of `advance`."""

    state: np.ndarray
    """`SUPPLY_SAMPLE`, (1,)."""
    records: SupplyRecords
    step: np.ndarray
    """The tick in s, (1,)."""
    rows: np.ndarray
    """Of its actuators, int64."""
    replies: np.ndarray
    """`LOAD_REPLY` of all actuators."""
    answers: np.ndarray
    """Their `SUPPLY_REPLY`, where the pressure moved in the tick, or none."""


class Answers(NamedTuple):
    """Memory of `keep_answers`: `SUPPLY_REPLY` of all actuators, and where they are kept."""

    fed: np.ndarray
    kept: np.ndarray


@kernel_function
def held_pressure(opening, ideal):
    """Return the pressure of an ideal supply whose dump valve has an opening  (C14), in Pa."""
    p = ideal.pressure_mpa
    return (p - opening * (p - ideal.return_mpa)) * MPA


@kernel
def fill_pressures(own):
    """Fill both pressures of its actuators; return 0."""
    state = own.state[0]
    for row in own.rows:
        own.ports[row].supply_pressure = state.pressure
        own.ports[row].return_pressure = state.return_pressure
    return 0


@kernel
def fill_line(own):
    """Fill the `SUPPLY_PORT` of its actuators; return 0."""
    fill_feeds(accumulator_node(own.supply[0], own.state[0]), own.rows, own.answers, own.feeds)
    return 0


@kernel
def keep_answers(own):
    """Keep the answers of a tick; return 0."""
    for row in range(len(own.kept)):
        own.kept[row] = own.fed[row]
    return 0


@kernel
def add_oil(drawn, returned, paid, seconds, state):
    """
    Add the volumes of one tick (m3), and their energy  (E1).

    ``paid`` is that of the oil drawn, J; the pressure of the return is held over the tick.
    """
    energy = paid - state.return_pressure * returned
    state.drawn += drawn
    state.returned += returned
    state.power = energy / seconds
    state.peak_power = max(state.peak_power, state.power)
    state.energy += energy


@kernel
def lower(ideal, state):
    """Let the dump of an ideal supply act over a tick  (C14)."""
    dump = ideal.dump_valve
    if dump.is_there > 0.0 and state.dump_opening != dump.is_open:
        state.dump_opening = opened_after(state.dump_opening, dump.left, dump)
        state.pressure = held_pressure(state.dump_opening, ideal)


@kernel
def advance(own):
    """Advance by one tick with the oil that its actuators drew and returned; return 0."""
    state, step = own.state[0], own.step[0]
    drawn, returned, paid = 0.0, 0.0, 0.0
    for row in own.rows:
        drawn += own.replies[row].supply_volume
        returned += own.replies[row].return_volume
    held = state.pressure * drawn
    if len(own.answers) > 0:
        for row in own.rows:
            paid += own.answers[row].paid
        state.held_energy += paid - held
    else:
        paid = held
    add_oil(drawn, returned, paid, step, state)
    substeps = round(step / SUPPLY_STEP)
    ideal, supply, line = own.records
    if len(supply) > 0:
        supply_advance(substeps, drawn / step, supply, own.state)
    else:
        state.pump_energy += state.pressure * drawn
        lower(ideal[0], state)
    if len(line) > 0:
        return_advance(substeps, returned / step, line, own.state)
    else:
        state.return_energy += state.return_pressure * returned
    return 0
