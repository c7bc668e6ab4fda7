"""
Largest forces of a CiA 402 drive: 0x6072 of both directions, 0x60E0 and 0x60E1 of each.

They limit the efforts of setpoints, and the output of the position block: the force with which it
drives to a target. The block has limits of its own (0x2030), which stay beneath: the smaller of
both is in force, and reaches the REU like a gain that the master writes.
"""

from collections.abc import Mapping

from isa_ros.fieldbus.device.axis import Axis, PER_MILLE
from isa_ros.fieldbus.device.cia402_objects import LARGEST_IN, LARGEST_OUT, MAX_TORQUE
from isa_ros.fieldbus.device.dictionary import Key
from isa_ros.fieldbus.device.manufacturer_area import tunable_keys
from isa_ros.fieldbus.device.objects import Value

_LEAST = 1e-3
"""N or Nm: a limit of 0 per mille, since a block must have some."""
_OUT, _IN = 'position.force_out', 'position.force_in'
_BOTH, _FORCES = 'position.limit', ('N', 'Nm')


class ForceLimits:
    """The limits of one drive; ``values`` are those of its dictionary."""

    def __init__(self, axis: Axis, values: Mapping[Key, Value]) -> None:
        self._axis, self._values = axis, values
        self._own = {one.name: one.value for one in tunable_keys(axis).values()
                     if one.name in (_OUT, _IN) or one.name == _BOTH and one.unit in _FORCES}
        """Of the block, by name, N or Nm."""
        self._applied = dict(self._own)

    @property
    def sides(self) -> tuple[float, float]:
        """Return the largest forces by these objects, pushing out and pulling in, N or Nm."""
        values, per_mille = self._values, self._axis.rated_force * PER_MILLE
        both = int(values[MAX_TORQUE])
        return (min(both, int(values[LARGEST_OUT])) * per_mille,
                min(both, int(values[LARGEST_IN])) * per_mille)

    def limited(self, changes: dict[str, float]) -> dict[str, float]:
        """Return changes of the REU with its limits as they are to be in force."""
        if not self._own:
            return changes
        self._own |= {name: changes[name] for name in self._own if name in changes}
        found = {name: value for name, value in changes.items() if name not in self._own}
        out, into = self.sides
        for name, own in self._own.items():
            side = min(out, into) if name == _BOTH else out if name == _OUT else into
            value = min(own, max(side, _LEAST))
            if value != self._applied[name]:
                self._applied[name] = found[name] = value
        return found

    def foreign(self, values: Mapping[str, float]) -> Mapping[str, float]:
        """Take values that are in force; return those that are not limits set by these objects."""
        found = {name: value for name, value in values.items()
                 if self._applied.get(name) != value}
        for name in self._own:
            if name in found:
                self._own[name] = self._applied[name] = found[name]
        return found
