"""
What a bag has of the samples: devices, counts and cavities, at the ticks of their messages.

``~/device`` has the device of an actuator when it changes, ``/diagnostics`` those of all then,
once a second and at the end, ``applied_parameters`` what was changed.
"""

from typing import NamedTuple

from isa_ros.bag.reader import Bag, BagMessage
from isa_ros.config.runs.run_config import RunConfig
from isa_ros.core.accounts import CHAMBERS
from isa_ros.core.constants import ATMOSPHERE
from isa_ros.core.signals import SAMPLE
from isa_ros.errors import BagError, SetpointError
from isa_ros.run.begins import begins_of
from isa_ros.run.diagnostics import ENERGY
from isa_ros.run.events import History, Trapped
from msg_adapters import device, diagnostics, event
from msg_adapters.actuator_messages import APPLIED_PARAMETERS, CUSHION_PRESSURE, DEVICE
from msg_adapters.applied_parameters import tuned_values
from msg_adapters.cdr import CdrError
from msg_adapters.coordinator_messages import APPLIED_PARAMETERS as OF_SUPPLIES, NODE
from msg_adapters.sensor_messages import pressure_in
import numpy as np

_CAVITY = CHAMBERS[-1]
_LAST = ('last_trip', 'trip_time', 'trip_value', 'trip_level')


class _Topics(NamedTuple):
    """The topics that are read, with the row of their actuator."""

    devices: dict[str, int]
    parameters: dict[str, int]
    cushions: dict[str, int]


def history_of(bag: Bag, run: RunConfig) -> History:
    """
    Return the history of a bag, whose configuration is ``run``.

    Raises
    ------
    BagError
        A message is not what its topic has.

    """
    names = [own.name for own in run.actuators]
    topics = _Topics({f'/{name}/{DEVICE[0]}': row for row, name in enumerate(names)},
                     {f'/{name}/{APPLIED_PARAMETERS[0]}': row for row, name in enumerate(names)},
                     {f'/{name}/{CUSHION_PRESSURE[0]}': row for row, name in enumerate(names)})
    trapped: dict[int, dict[int, float]] = {}
    tuned: dict[int, dict[int, dict[str, float]]] = {}
    supplies: dict[int, dict[str, float]] = {}
    now = np.zeros(len(names), SAMPLE)
    rows: list[np.ndarray] = []
    ticks: list[int] = []
    read = {*topics.devices, *topics.parameters, *topics.cushions, diagnostics.TOPIC[0],
            OF_SUPPLIES[0], event.TOPIC[0]}
    events: dict[int, list[str]] = {}
    for message in bag.messages(read):
        try:
            is_new = _read(message, topics, names, now)
            row = topics.parameters.get(message.topic)
            if row is not None:
                tuned.setdefault(message.sequence, {})[row] = tuned_values(
                    message.data, names[row])
            elif message.topic in topics.cushions:
                trapped.setdefault(topics.cushions[message.topic], {})[message.sequence] = (
                    pressure_in(message.data) - ATMOSPHERE)
            elif message.topic == OF_SUPPLIES[0]:
                supplies[message.sequence] = tuned_values(message.data, NODE)
            elif message.topic == event.TOPIC[0]:
                events.setdefault(message.sequence, []).append(event.text(message.data))
        except (CdrError, KeyError, SetpointError, ValueError) as error:
            raise BagError(f'{bag.place_of(message)}: {error}') from error
        if not is_new:
            continue
        if ticks and ticks[-1] == message.sequence:
            rows[-1] = now.copy()
        else:
            ticks.append(message.sequence)
            rows.append(now.copy())
    samples = np.array(rows, SAMPLE).reshape(-1, len(names))
    return History(
        ticks, samples, tuned, supplies,
        {row: Trapped(list(own), np.array(list(own.values()))) for row, own in trapped.items()},
        events, begins_of(bag, run, ticks, samples))


def _read(message: BagMessage, topics: _Topics, names: list[str], now: np.ndarray) -> bool:
    """Read a message into the samples of ``now``; return whether it is one of a device."""
    topic = message.topic
    if topic in topics.devices:
        _fill(now, topics.devices[topic], device.sample_fields(device.values(message.data)))
        return True
    if topic == diagnostics.TOPIC[0]:
        for name, values in diagnostics.values(message.data, device.TASK).items():
            _fill(now, names.index(name), device.sample_fields(values))
        for name, values in diagnostics.values(message.data, ENERGY).items():
            if name in names and _CAVITY.key in values:
                now[_CAVITY.field][names.index(name)] = (
                    float(values[_CAVITY.key]) * _CAVITY.scale)
        return True
    return False


def _fill(now: np.ndarray, row: int, fields: dict[str, float]) -> None:
    if not fields['last_trip']:     # bags of before name what trips, without value and time
        fields |= _last_trip(now[row], fields)
    for field, value in fields.items():
        now[field][row] = value


def _last_trip(before: np.void, fields: dict[str, float]) -> dict[str, float]:
    """Return the fields of the last trip, as far as the set of conditions shows it."""
    new = int(fields['trips']) & ~int(before['trips'])
    if not new:
        return {field: float(before[field]) for field in _LAST}
    values = float(new & -new), fields['state_since'], np.nan, np.nan
    return dict(zip(_LAST, values))
