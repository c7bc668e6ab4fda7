"""
Messages of a tick that are encoded as they come: changed parameters, devices, diagnostics.

They have texts, or values of any number, so that they have no place in a prepared block.
"""

from collections.abc import Iterator, Mapping, Sequence

from isa_ros.core.accounts import accounts_of
from isa_ros.core.bound import Bound
from isa_ros.core.device import FIELDS, is_status_due
from isa_ros.core.record import floats
from isa_ros.core.signals import Records, SAMPLE
from isa_ros.run.diagnostics import energy_statuses, PERIOD_NS
from isa_ros.run.due_devices import DevicesDue, is_any_due
from msg_adapters import actuator_messages, coordinator_messages, device, diagnostics
from msg_adapters.applied_parameters import applied_parameters
import numpy as np

PARAMETERS, DEVICE = actuator_messages.APPLIED_PARAMETERS[0], actuator_messages.DEVICE[0]
OF_SUPPLIES = coordinator_messages.APPLIED_PARAMETERS[0]
DIAGNOSTICS = diagnostics.TOPIC[0]
_FIELDS = tuple(SAMPLE.names or ())
_OF_STATUS = [_FIELDS.index(name) for name in ('state_since', 'age', 'is_stale')]


class RareMessages:
    """
    The messages of the last tick by topic; `pack` replaces them.

    ``actuators`` and ``supplies`` are names, ``samples`` and ``supply_samples`` their rows.
    ``is_run``: there are diagnostics of them all, every second, on change and at the end.
    """

    def __init__(
            self, actuators: Sequence[str], samples: Records, supplies: Sequence[str],
            supply_samples: Records, is_run: bool) -> None:
        self._actuators, self._samples = actuators, samples
        self._supplies, self._supply_samples = supplies, supply_samples
        self._values = floats(samples)
        self._due = DevicesDue(samples, np.zeros(2, np.int64))
        self._is_any_due = Bound(is_any_due, self._due)
        self._is_run = is_run
        self._t_ns = self._start_ns = 0
        self._found: dict[str, bytes] = {}
        self._announces = False

    def announce(self) -> None:
        """Let the next tick have a message of every device: it continues a saved state."""
        self._announces = True

    def pack(
            self, t_ns: int, tick_start_ns: int, tuned: Mapping[int, Mapping[str, float]],
            tuned_supplies: Mapping[str, float], start_ns: int = 0) -> None:
        """
        Encode the messages of ``t_ns``; arguments as `isa_ros.run.packing.Packer.pack`.

        ``start_ns`` is the time of stamps at t = 0.
        """
        self._t_ns, self._start_ns = t_ns, start_ns
        applied_ns = start_ns + tick_start_ns
        self._found = {}
        for row, values in tuned.items():
            name = self._actuators[row]
            self._found[f'/{name}/{PARAMETERS}'] = applied_parameters(name, values, applied_ns)
        if tuned_supplies:
            self._found[OF_SUPPLIES] = applied_parameters(
                coordinator_messages.NODE, tuned_supplies, applied_ns)
        changed = self.devices(t_ns, tick_start_ns)
        self._announces = False
        for row in changed:
            name = self._actuators[row]
            self._found[f'/{name}/{DEVICE}'] = device.pack(name, self._device(row))
        if self._is_run and (changed or t_ns % PERIOD_NS == 0):
            self.diagnose()

    def devices(self, t_ns: int, tick_start_ns: int) -> list[int]:
        """Return the rows of which a tick has a message of the device; after `announce` all."""
        if self._announces:
            return list(range(len(self._actuators)))
        self._due.times[:] = t_ns, tick_start_ns
        if not self._is_any_due.run():      # at nearly every tick
            return []
        statuses = self._values[:, _OF_STATUS].tolist()
        return [row for row, (since, age, is_stale) in enumerate(statuses)
                if is_status_due(since, age, is_stale, t_ns, tick_start_ns)]

    def diagnose(self) -> bytes:
        """Add the diagnostics of all, and return them."""
        self._found[DIAGNOSTICS] = found = diagnostics.pack(self._start_ns + self._t_ns, [
            *(device.joined(name, self._device(row))
              for row, name in enumerate(self._actuators)),
            *energy_statuses(accounts_of(
                self._actuators, self._samples, self._supplies, self._supply_samples,
                self._t_ns))])
        return found

    def _device(self, row: int) -> dict[str, float]:
        sample = self._samples[row]
        return {field: float(sample[field]) for field in FIELDS}

    def get(self, topic: str) -> bytes | None:
        """Return the message of a topic, or None."""
        return self._found.get(topic)

    def items(self) -> Iterator[tuple[str, bytes]]:
        """Yield topics and messages."""
        yield from self._found.items()
