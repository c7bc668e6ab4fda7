"""
The options of a run, each declared once: a field of `Request`.

The arguments of `isa bringup`, the ROS parameters of the coordinator and the arguments of the
launch file are made from `OPTIONS`, and `Request` is filled from their values. This module
imports neither ROS nor numba: `isa --help` and launch files import it.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields, MISSING, replace
from enum import Enum
from pathlib import Path
import re
from typing import Any

from isa_ros.config.paths import CONFIG, find, SCENARIOS
from isa_ros.errors import ConfigError
from isa_ros.run.pacing import JOIN_TIMEOUT_S, Laps

COMPRESSIONS = ('none', 'lz4', 'zstd')

RosValue = bool | int | float | str | list[str]

SET_HELP = (
    'another value in {config}, by its key and in its unit, as isa params shows them; keys of the '
    'scenario begin with scenario.')


class Kind(Enum):
    """Kind of an option's value."""

    CONFIG = CONFIG
    """Path of a run file, or name of a shipped one."""
    SCENARIO = SCENARIOS
    """Path of a scenario file, or name of a shipped one."""
    PATH = 'path'
    NEW_FILE = 'new file'
    TEXT = 'text'
    COMPRESSION = 'compression'
    POSITIVE = '> 0'
    NOT_NEGATIVE = '>= 0'
    WHOLE = 'whole number >= 0'
    FLAG = 'flag'
    NAMES = 'names'
    """Names, separated by commas on the command line."""
    REPEATED = 'repeated'
    """One name for each time the option is given on the command line."""
    CHANGES = 'changes'
    """One KEY=VALUE for each time the option is given on the command line."""


_SHIPPED = (Kind.CONFIG, Kind.SCENARIO)
_LISTS: Mapping[Kind, str] = {
    Kind.NAMES: 'names', Kind.REPEATED: 'names', Kind.CHANGES: 'KEY=VALUE'}
"""Entries of the kinds that are lists."""
_COMMA = {
    kind: re.compile(r',(?=[^,=\[{]+=)' if kind is Kind.CHANGES else ',') for kind in _LISTS}
"""What separates entries in a launch file; the value of a change may have commas too."""
_UNSET: Mapping[Kind, tuple[RosValue, str]] = {
    Kind.POSITIVE: (0.0, '0'), Kind.NOT_NEGATIVE: (-1.0, '< 0'), Kind.WHOLE: (-1, '< 0'),
    Kind.FLAG: (False, 'false')}
"""Value of a ROS parameter that is not set, and its text in help; other kinds: an empty text."""
_EMPTY: tuple[RosValue, str] = ('', 'empty')
_FLAGS = {'true': True, '1': True, 'false': False, '0': False}


@dataclass(frozen=True, kw_only=True)
class Option:
    """One option: its name, its help text, and the interfaces that have it."""

    kind: Kind
    meaning: str
    """``{config}`` stands for the run file."""
    otherwise: str = ''
    """Default, as text."""
    unit: str = ''
    metavar: str | None = None
    name: str = ''
    """Name on the command line (there with dashes) and in a launch file; '': that of the field."""
    parameter: str = ''
    """Name of the ROS parameter; '': ``name``."""
    launch_default: str = ''
    """'': that of the parameter."""
    is_argument: bool = True
    is_parameter: bool = True
    is_of_bus: bool = True
    """Whether `isa bus` has it, of those on the command line."""

    field: str = ''
    """Name of the field of `Request`."""
    default: Any = None
    is_required: bool = False

    @property
    def argument_help(self) -> str:
        """Return the help of the command line."""
        text = self.meaning + (f' (default: {self.otherwise})' if self.otherwise else '')
        text += '; may be repeated' if self.kind is Kind.REPEATED else ''
        return text.format(config='CONFIG')

    @property
    def description(self) -> str:
        """Return the help of the ROS parameter and of the launch file's argument."""
        text = self.meaning + (f', {self.unit}' if self.unit else '')
        if self.kind is Kind.COMPRESSION:
            text += f': {", ".join(COMPRESSIONS)}'
        if self.kind in _LISTS:
            text += f'; a list of {_LISTS[self.kind]}, in a launch file separated by commas'
        elif self.default is None and not self.is_required:
            text += f'; {_UNSET.get(self.kind, _EMPTY)[1]}: {self.otherwise or "none"}'
        return text.format(config='the run file')

    @property
    def parameter_default(self) -> RosValue | None:
        """Return the default of the ROS parameter; None: an empty list."""
        if self.kind in _LISTS:
            return None
        unset: RosValue = _UNSET.get(self.kind, _EMPTY)[0]
        return unset if self.default is None else self.default

    @property
    def launch_text(self) -> str:
        """Return the default of the launch file's argument."""
        if self.kind in _LISTS:
            return ''
        return self.launch_default or str(self.parameter_default).lower()

    def of_argument(self, value: Any) -> Any:
        """Return the value for `Request` of a checked command-line argument."""
        if self.kind in _SHIPPED:
            return None if value is None else find(value, self.kind.value)
        return tuple(value) if self.kind in _LISTS else value

    def of_parameter(self, value: Any) -> Any:
        """Return the value for `Request` of a ROS parameter."""
        if self.kind in _LISTS:
            return tuple(value or ())
        if self.kind in (Kind.NOT_NEGATIVE, Kind.WHOLE):
            return None if value < 0.0 else value
        if self.default is None and value == self.parameter_default:
            return None
        return Path(value) if self.kind in (Kind.PATH, Kind.NEW_FILE) else self.of_argument(value)

    def of_launch(self, text: str) -> RosValue:
        """
        Return the value of the ROS parameter for the text of the launch file's argument.

        Raises
        ------
        ConfigError
            The text is not of the option's kind.

        """
        if self.kind in _LISTS:
            return [entry for entry in _COMMA[self.kind].split(text) if entry]
        if self.kind is Kind.FLAG:
            return flag(self.name, text)
        if self.kind in (Kind.POSITIVE, Kind.NOT_NEGATIVE):
            try:
                return float(text)
            except ValueError:
                raise ConfigError(f'{self.name}:={text}, must be a number') from None
        if self.kind is Kind.WHOLE:
            try:
                return int(text)
            except ValueError:
                raise ConfigError(f'{self.name}:={text}, must be a whole number') from None
        return text


def _option(kind: Kind, meaning: str, **more: Any) -> Mapping[str, Option]:
    return {'option': Option(kind=kind, meaning=meaning, **more)}


@dataclass(frozen=True, kw_only=True)
class Request:
    """Options of a run; a field without an option can be set by programs only."""

    config: Path = field(metadata=_option(
        Kind.CONFIG, 'a run file, or a shipped one by name', metavar='CONFIG',
        parameter='config_file', launch_default='leg.yaml'))
    scenario: Path | None = field(default=None, metadata=_option(
        Kind.SCENARIO, 'commands over time: a file, or a shipped one by name', metavar='FILE',
        parameter='scenario_file'))
    changes: tuple[str, ...] = field(default=(), metadata=_option(
        Kind.CHANGES, SET_HELP, metavar='KEY=VALUE', name='set'))
    seed: int | None = field(default=None, metadata=_option(
        Kind.WHOLE, 'of all noise of the run', otherwise='that of {config}', metavar='N'))
    duration_s: float | None = field(default=None, metadata=_option(
        Kind.POSITIVE, 'simulated time', otherwise='that of the scenario, else until Ctrl-C',
        unit='s', metavar='S', name='duration'))
    out: Path | None = field(default=None, metadata=_option(
        Kind.PATH, 'directory of the bag', otherwise='a new one in runs/', metavar='DIR'))
    overwrite: bool = field(default=False, metadata=_option(
        Kind.FLAG, 'replace the bag in an existing directory'))
    compression: str | None = field(default=None, metadata=_option(
        Kind.COMPRESSION, 'of the chunks of the bag', otherwise='that of {config}, else none'))
    split_mb: float | None = field(default=None, metadata=_option(
        Kind.NOT_NEGATIVE, 'begin a new file of the bag after N MB, 0: never',
        otherwise='that of {config}', metavar='N'))
    is_synced: bool = field(default=False, metadata=_option(
        Kind.FLAG, 'wait at each chunk of the bag until the disk has it (fsync): then a failure '
        'of the power loses as little as a killed run', name='sync'))
    real_time_factor: float | None = field(default=None, metadata=_option(
        Kind.POSITIVE, 'not faster than X times real time', otherwise='as fast as possible',
        metavar='X'))
    in_process: bool = field(default=False, metadata=_option(
        Kind.FLAG, 'all nodes in one process: faster, and the same bytes in the bag',
        is_of_bus=False))
    elsewhere: tuple[str, ...] = field(default=(), metadata=_option(
        Kind.NAMES, 'actuators that `isa actuators` starts on another host; the run waits for '
        'them', metavar='NAME[,NAME...]|all', is_parameter=False, is_of_bus=False))
    """(`run_config.ALL`,): all of them."""
    controllers: tuple[str, ...] = field(default=(), metadata=_option(
        Kind.REPEATED, 'a node of yours; the run waits for it at every tick', metavar='NAME',
        name='controller', parameter='controllers', is_of_bus=False))
    """Added to those of the run file."""
    join_timeout_s: float = field(default=JOIN_TIMEOUT_S, metadata=_option(
        Kind.POSITIVE, 'longest wait for participants',
        otherwise=f'{JOIN_TIMEOUT_S:g} s', unit='s', metavar='S', name='join_timeout',
        parameter='join_timeout_s', is_of_bus=False))
    is_paused: bool = field(default=False, metadata=_option(
        Kind.FLAG, 'wait before tick 0 for /coordinator/step or the end of the pause',
        name='paused'))
    restore: Path | None = field(default=None, metadata=_option(
        Kind.PATH, 'continue from a saved state', metavar='FILE'))
    save: Path | None = field(default=None, metadata=_option(
        Kind.NEW_FILE, 'save the state at the end to a file', metavar='FILE'))
    namespace: str = field(default='', metadata=_option(
        Kind.TEXT, 'of all nodes', is_argument=False, is_parameter=False))
    is_alone: bool = False
    """Whether this process does nothing but the run: then the loaded objects need no garbage
    collection and, if the process has had no node yet, actuator processes may be forked."""
    laps: Laps | None = None
    """Measures the host time of every phase of the ticks."""

    @property
    def all_changes(self) -> tuple[str, ...]:
        """Return `changes` and the seed, as one more of them."""
        return with_seed(self.changes, self.seed)


def with_seed(changes: Sequence[str], seed: int | None) -> tuple[str, ...]:
    """Return the changes of a request and its seed, if it has one, as the last of them."""
    return (*changes, *(() if seed is None else (f'seed={seed}',)))


def _declared() -> tuple[Option, ...]:
    options = []
    for f in fields(Request):
        option: Option | None = f.metadata.get('option')
        if option is not None:
            name = option.name or f.name
            options.append(replace(
                option, name=name, parameter=option.parameter or name, field=f.name,
                default=None if f.default is MISSING else f.default,
                is_required=f.default is MISSING))
    return tuple(options)


OPTIONS = _declared()
"""In the order of `isa bringup --help`."""

OPTION_OF = {option.parameter: option for option in OPTIONS}
"""By name of the ROS parameter."""


def request_of_arguments(values: Mapping[str, Any], **more: Any) -> Request:
    """Return the request of a command line's values, by the names of the options it has."""
    return Request(**{option.field: option.of_argument(values[option.name])
                      for option in OPTIONS
                      if option.is_argument and option.name in values}, **more)


def request_of_parameters(values: Mapping[str, Any], **more: Any) -> Request:
    """Return the request of the coordinator's ROS parameters, by their names."""
    return Request(**{option.field: option.of_parameter(values[option.parameter])
                      for option in OPTIONS if option.is_parameter}, **more)


def launched_parameters(texts: Mapping[str, str]) -> dict[str, RosValue]:
    """
    Return the coordinator's ROS parameters, less its files, for a launch file's arguments.

    Empty lists are left out: launch has none.
    """
    values = {option.parameter: option.of_launch(texts[option.name]) for option in OPTIONS
              if option.is_parameter and option.kind not in _SHIPPED}
    return {name: value for name, value in values.items() if value != []}


def flag(name: str, text: str) -> bool:
    """
    Return the value of a launch file's argument that is true or false.

    Raises
    ------
    ConfigError
        The text is neither.

    """
    if text.lower() not in _FLAGS:
        raise ConfigError(f'{name}:={text}, must be true or false')
    return _FLAGS[text.lower()]


def launched_elsewhere(texts: Mapping[str, str]) -> tuple[str, ...]:
    """Return the actuators that a launch file does not start."""
    return tuple(text for text in texts['elsewhere'].split(',') if text)
