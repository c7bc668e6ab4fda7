"""
The emergency stop of groups of actuators: one trips or somebody asks, all stop.

The line of a group is a value of the surroundings, 0 or 1, so that scenarios, services, bags and
saved states have it as any other. At the beginning of a tick it is opened by the trips of its
members, and what hangs on it follows in that tick: `reu.device.emergency_stop` of each actuator,
and the dump valves of the supplies, at once or when the movements have ended. All of it depends
on the samples and values at the tick's start alone, wherever the actuators compute.
"""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

from isa_ros.actuator.tuning import values_in_force
from isa_ros.config.runs.emergency_stops import AT_REST, NEVER
from isa_ros.config.runs.run_config import ActuatorConfig, RunConfig
from isa_ros.core.conditions import BITS, conditions
from isa_ros.core.device import DISABLED, FAULT
from isa_ros.core.signals import Records
from isa_ros.core.suggest import alternatives
from isa_ros.core.timebase import NS_PER_SECOND
from isa_ros.errors import ConfigError
from isa_ros.reu.protection_sheet import changed_reactions, reaction_of
from isa_ros.surroundings.emergency_line import line_of, OPEN
from isa_ros.surroundings.supply import is_dumped
from isa_ros.surroundings.surroundings import Surroundings
import numpy as np

LINE = 'reu.device.emergency_stop'
"""Of an actuator."""
DUMP = 'dump.opened'
"""Of a supply with a dump valve."""
LONGEST_STOP = 2.0      # s that a dump waits for an actuator from which nothing comes
_TICKS = np.dtype('<i8')   # for which a line has been open


class StopGroup(NamedTuple):
    """One group, as a run needs it."""

    line: str
    """Name of its line in `Surroundings.changing`."""
    trips: Mapping[int, int]
    """By row of each actuator: bits of the conditions whose trip opens the line, by its sheet."""
    reactions: Sequence[str]
    """Of these conditions."""
    supplies: Sequence[str]
    """Those whose dump valves open."""
    waits: bool
    """Whether these wait until the actuators are off."""


class EmergencyStops:
    """
    The lines of the groups over a run of ``actuators``, by row.

    ``surroundings`` have the lines and the dump valves among their values; ``step`` is the tick
    in s.
    """

    def __init__(
            self, groups: Sequence[StopGroup], actuators: Sequence[ActuatorConfig],
            surroundings: Surroundings, step: float) -> None:
        self._groups, self._actuators = tuple(groups), actuators
        self._surroundings, self._step = surroundings, step
        self._told: dict[int | str, bool | None] = {}
        self.restart()

    def restart(self) -> None:
        """Begin at t = 0, with the reactions of the sheets; participants are told anew."""
        self._told = dict.fromkeys(self._told)
        self._is_idle = False
        self._lasted = dict.fromkeys((group.line for group in self._groups), 0)
        self._trips = {group.line: dict(group.trips) for group in self._groups}

    def snapshot(self) -> bytes:
        """Return for how many ticks each line has been open."""
        return np.array([self._lasted[group.line] for group in self._groups], _TICKS).tobytes()

    def lasted_in(self, snapshot: bytes, tick: int) -> Sequence[int]:
        """
        Return what `restore` needs of a `snapshot` at ``tick``.

        Raises
        ------
        ConfigError
            It is not one of these groups, or a line has been open before t = 0.

        """
        expected = len(self._groups) * _TICKS.itemsize
        if len(snapshot) != expected:
            raise ConfigError(
                f'saved state of the emergency stops has {len(snapshot)} bytes, must have '
                f'{expected}')
        lasted: list[int] = np.frombuffer(snapshot, _TICKS).tolist()
        for group, own in zip(self._groups, lasted):
            if not 0 <= own <= tick:
                raise ConfigError(
                    f'{group.line}: saved state has it open for {own} ticks, must be >= 0 and <= '
                    f'{tick}')
        return lasted

    def restore(self, participants: Sequence[bytes], lasted: Sequence[int]) -> None:
        """
        Go on with ``participants`` of a saved state, actuators first, and their reactions.

        ``lasted`` is from `lasted_in`.
        """
        for group in self._groups:
            self._told |= dict.fromkeys([*group.trips, *group.supplies])
        self.restart()
        self._lasted = {group.line: own for group, own in zip(self._groups, lasted)}
        self.take_tuned({row: values_in_force(own.sheet, own.load, state) for row, (own, state)
                         in enumerate(zip(self._actuators, participants))})

    def take_tuned(self, tuned: Mapping[int, Mapping[str, float]]) -> None:
        """Take the parameters that changed, by row: reactions in force open the lines."""
        for row, values in tuned.items():
            for condition, reaction in changed_reactions(values):
                for group in self._groups:
                    trips, bit = self._trips[group.line], 1 << BITS[condition]
                    if row in trips:
                        opens = reaction in group.reactions
                        trips[row] = trips[row] | bit if opens else trips[row] & ~bit

    def cause(self, group: StopGroup, samples: Records) -> str:
        """Return the trips that open the line of a group, or ''."""
        found = []
        for row, bits in self._trips[group.line].items():
            tripped = int(samples[row]['trips']) & bits
            if tripped:
                found.append(f'{self._actuators[row].name} {" ".join(conditions(tripped))}')
        return ', '.join(found)

    def request(self, is_open: bool, samples: Records, group: str | None = None) -> None:
        """
        Open or close the line of a group from the next tick on; None: of all groups.

        Raises
        ------
        ConfigError
            There is no such group, ``is_open`` is neither of both, or a trip in ``samples`` would
            open its line again.

        """
        if is_open not in (False, True):
            raise ConfigError(
                f'emergency_stop = {is_open!r}, must be True (open) or False (released)')
        lines = {own.line: own for own in self._groups}
        if group is not None:
            line = f'{line_of(group)}.{OPEN}'
            if line not in lines:
                names = [name.split('.')[1] for name in lines]
                raise ConfigError(f'{group!r} is not a group; {alternatives(group, names)}')
            lines = {line: lines[line]}
        if not is_open:
            for own in lines.values():
                if cause := self.cause(own, samples):
                    raise ConfigError(f'{own.line} stays open: {cause}; clear the fault first')
        self._surroundings.tune(dict.fromkeys(lines, float(is_open)))

    def act(
            self, samples: Records, changes: Mapping[int, Mapping[str, float]]
            ) -> Mapping[int, Mapping[str, float]]:
        """
        Open lines whose members have tripped, and let all follow their lines.

        ``samples`` are those of the tick's start, (n,); ``changes`` of its parameters by row are
        returned with those of the lines.
        """
        is_settled = self._surroundings.is_settled
        if self._is_idle and is_settled and not samples['trips'].any():
            return changes
        self._is_idle = True
        lines: dict[int, bool] = {row: False for group in self._groups for row in group.trips}
        dumps: dict[str, bool] = {name: False for group in self._groups
                                  for name in group.supplies}
        for group in self._groups:
            if self.cause(group, samples):
                self._surroundings.tune({group.line: 1.0})
            if self._surroundings.tuned_value(group.line) == 0.0:
                self._lasted[group.line] = 0
                continue
            self._lasted[group.line] += 1
            self._is_idle = False
            lines.update(dict.fromkeys(group.trips, True))
            are_asked = self._lasted[group.line] * self._step < LONGEST_STOP
            if not group.waits or all(
                    _is_off(samples[row], are_asked) for row in group.trips):
                dumps.update(dict.fromkeys(group.supplies, True))
        if changed := {f'{name}.{DUMP}': float(is_open) for name, is_open in dumps.items()
                       if self._is_new(name, is_open)}:
            self._surroundings.tune(changed)
        new = {row: float(is_open) for row, is_open in lines.items()
               if self._is_new(row, is_open)}
        return {**changes, **{
            row: {**changes.get(row, {}), LINE: value} for row, value in new.items()}}

    def is_quiet(self, samples: Records) -> bool:
        """Return whether `act` changes nothing as long as ``samples`` have no other trips."""
        return not self._groups or (self._is_idle and not samples['trips'].any())

    def _is_new(self, of: int | str, is_open: bool) -> bool:
        """Note what an actuator or a supply is told; return whether it was told otherwise."""
        was, self._told[of] = self._told.get(of, False), is_open
        return was != is_open


def _is_off(sample: Records, is_asked: bool) -> bool:
    """Return whether an actuator moves by itself no more; one that is silent is, after a time."""
    if sample['is_stale']:
        return not is_asked
    return bool(sample['device_state'] in (DISABLED, FAULT))


def emergency_stops_of(run: RunConfig, surroundings: Surroundings) -> EmergencyStops:
    """Return the emergency stops of a run, for its ticks."""
    groups = []
    for group in run.stop_groups:
        sheets = {run.index(name): run.actuator(name).sheet for name in group.actuators}
        groups.append(StopGroup(
            f'{line_of(group.name)}.{OPEN}', {
                row: sum(1 << bit for condition, bit in BITS.items()
                         if reaction_of(sheet.reu.protection, condition) in group.reactions)
                for row, sheet in sheets.items()},
            group.reactions, [] if group.dumps == NEVER else [
                supply.name for supply in run.supplies
                if is_dumped(supply.sheet)
                and set(supply.feeds) & set(group.actuators)],
            group.dumps == AT_REST))
    return EmergencyStops(
        groups, run.actuators, surroundings, run.step_ns / NS_PER_SECOND)
