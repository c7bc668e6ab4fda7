"""Changed values of one actuator: accepted between two ticks, in force from the next one."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from isa_ros.actuator.link import link_record, NONE
from isa_ros.actuator.service_channel import nothing, ServiceChannel, travels
from isa_ros.actuator.sheet import actuator_record, ActuatorSheet
from isa_ros.actuator.tunable import (
    changed_together, changing, GAINS, LOAD, named, PROTECTION, with_changed_load)
from isa_ros.actuator.usable import refuse_timeout
from isa_ros.core.changeable import Changeable
from isa_ros.core.changing_values import bare, ChangingValues
from isa_ros.core.record import row_record
from isa_ros.core.signals import COMMAND, HAS_GAINS
from isa_ros.errors import ConfigError
from isa_ros.loads.sheets import Blocked, local_port, LocalLoad, move_support, write_port
from isa_ros.plant.plant import plant_record
import numpy as np

_NO_LOOPS = ('plant.', 'link.', LOAD, PROTECTION)
"""How the names of values that are not of the REU's loops begin."""


class Tuning:
    """
    Keeps an `ACTUATOR` row up to date; the states of plant and loops are unchanged.

    ``constants`` is that row, shape (1,), made from ``sheet`` with ``offset_steps``; ``name`` is
    the actuator's. Values of `GAINS` take effect with the setpoints and are only stored here.
    The REU's own model of its actuator stays that of the sheet when the plant changes. ``load`` is
    its own and ``port`` the `LOAD_PORT` of that, (1,), for ticks of ``tick`` s. ``link`` is the
    `LINK_STATE` of its link, by whose service channel values of the REU come; None: it has none.
    """

    def __init__(
            self, name: str, sheet: ActuatorSheet, offset_steps: int, constants: np.ndarray,
            load: LocalLoad | None, port: np.ndarray, tick: float,
            link: np.record | None = None) -> None:
        self._name = name
        self._sheet = sheet
        self._offset_steps = offset_steps
        self._constants = constants
        self._written = {part: constants[part].copy() for part in ('plant', 'reu', 'link')}
        self._load, self._port, self._tick = load, port, tick
        self._rest = 0.0
        self._known = changing(sheet, load)
        self.values = ChangingValues(
            name, list(self._known), [own.value for own in self._known.values()])
        """All that may change."""
        self._channel = None if link is None else ServiceChannel(
            row_record(constants).link, link, self.values, travels(self._known))

    def reset(self, rest: float) -> dict[str, float]:
        """
        Restore the sheet's values until the next tick; return the `GAINS` accepted for it.

        The load is at ``rest``, m or rad.
        """
        accepted = self.values.restart()
        if self._channel is not None:
            self._channel.clear()
        self._rest = rest
        if self._load is not None:
            self._port[:] = local_port(self._load, rest)
        self._write()
        return {name: value for name, value in accepted.items() if name in GAINS}

    def accept(self, values: Mapping[str, float]) -> Mapping[str, float]:
        """
        Accept new values by key or `named`, all or none; return those of the next tick, `named`.

        The last of several before one tick wins. A name may begin with `OVER` or `OFF`.

        Raises
        ------
        ConfigError
            As `isa_ros.actuator.tunable.with_changed`.

        """
        try:
            values = {key[:len(key) - len(bare(key))] + name: value
                      for key, given in values.items()
                      for name, value in named(self._known, {bare(key): given}).items()}
        except ConfigError as error:
            raise ConfigError(f'{self._name}: {error}') from error
        self._refuse_odd(values)
        for all_values in self.values.with_accepted(values):
            self._changed_by(all_values)
        self.values.accept(values)
        return {bare(name): self.values.value(bare(name)) for name in values}

    def _refuse_odd(self, values: Mapping[str, float]) -> None:
        """Refuse unknown names, and values that are not numbers, before any of them is kept."""
        self._changed_by({
            bare(name): value for name, value in values.items()
            if bare(name) not in self._known or isinstance(value, bool)
            or not isinstance(value, (int, float))})

    def known(self, name: str) -> Changeable:
        """Return one of `changing` by its key or its name."""
        return self._known.get(name) or next(
            own for own in self._known.values() if own.key == name)

    def value(self, name: str) -> float:
        """Return the last accepted value."""
        return self.values.value(name)

    def latch(self, step: int) -> bool:
        """
        Begin the tick at plant step ``step``: put the accepted values in force.

        Behind a link those of the REU are, which a frame has brought. Returns whether one of a
        loop changed.
        """
        if self.values.is_settled:
            return False
        is_changed = (self.values.latch() if self._channel is None
                      else self._channel.latch(step))
        self._write_load()
        if not is_changed:
            return False
        self._write()
        return not all(name.startswith(_NO_LOOPS) for name in self.applied)

    def _write_load(self) -> None:
        """Fill the port; a support moves in the tick after a change and rests in the next one."""
        if self._load is None:
            return
        write_port(with_changed_load(self._load, self.values.in_force, self._known), self._port)
        if isinstance(self._load, Blocked):
            before, now = self.values.change(f'{LOAD}displacement')
            move_support(self._rest, before, now, self._tick, self._port)

    def _changed_by(self, values: Mapping[str, float]) -> ActuatorSheet:
        try:
            sheet = changed_together(self._sheet, self._load, values, self._known)[0]
            if sheet.reu.protection is not self._sheet.reu.protection:
                refuse_timeout(sheet, self._tick)
            return sheet
        except ConfigError as error:
            raise ConfigError(f'{self._name}: {error}') from error

    def _write(self) -> None:
        """Fill the constants from the values in force, each part from its own section."""
        own, sheet = self._sheet, self._changed_by(self.values.in_force)
        for part, written in self._written.items():
            section: Any = getattr(sheet, part)
            if section is getattr(own, part):
                self._constants[part] = written
            elif part == 'plant':
                self._constants[part] = plant_record(section)
            elif part == 'link':
                self._constants[part] = link_record(section)
            else:
                self._constants[part] = actuator_record(
                    replace(own, reu=section), self._offset_steps)[part]

    @property
    def applied(self) -> dict[str, float]:
        """Return the changes at the start of the last tick without `GAINS`, outermost first."""
        changed = self.values.applied
        return {name: value for name, value in changed.items() if name not in GAINS}

    @property
    def nbytes(self) -> int:
        """Return the size of a `snapshot`."""
        return self.values.nbytes + (0 if self._channel is None else self._channel.nbytes)

    def snapshot(self) -> bytes:
        """Return the state as bytes for `restore`."""
        return self.values.snapshot() + (
            b'' if self._channel is None else self._channel.snapshot())

    def restore(self, snapshot: bytes) -> None:
        """
        Continue from a `snapshot`.

        Raises as `accept`, also for a value that is not finite; then all is as before.
        """
        before = self.snapshot()
        try:
            self._take(snapshot)
        except ConfigError:
            self._take(before)
            raise

    def _take(self, snapshot: bytes) -> None:
        self.values.restore(snapshot[:self.values.nbytes])
        if self._channel is not None:
            self._channel.restore(snapshot[self.values.nbytes:])
        self._changed_by(self.values.accepted)
        self._write()


def values_in_force(
        sheet: ActuatorSheet, load: LocalLoad | None, snapshot: bytes) -> dict[str, float]:
    """
    Return the values in force that are not those of the sheet, from a `SmartActuator.snapshot`.

    Raises
    ------
    ConfigError
        A value is not finite.

    """
    known = changing(sheet, load)
    values = ChangingValues('saved state', list(known), [own.value for own in known.values()])
    channel = 0 if sheet.link.kind == NONE else nothing(travels(known)).nbytes
    end = len(snapshot) - channel
    values.restore(snapshot[end - values.nbytes:end])
    return values.in_force


def gains_command(values: Mapping[str, float]) -> np.void:
    """Return the `COMMAND` row of the `GAINS` among tuned values; without any, kinds is 0."""
    command: np.void = np.zeros(1, COMMAND)[0]
    command['kinds'] = 0 if GAINS.keys().isdisjoint(values) else HAS_GAINS
    for name, gain in GAINS.items():
        command[gain] = values.get(name, np.nan)
    return command
