"""
One option of a run, and its value on the command line, as ROS parameter and in a launch file.

This module imports neither ROS nor numba, as `isa_ros.run.options`.
"""

from collections.abc import Mapping
from enum import Enum
from pathlib import Path
import re
from typing import Any

from isa_ros.config.paths import CONFIG, find, SCENARIOS
from isa_ros.core.frozen import frozen
from isa_ros.errors import ConfigError

_LONGEST_NAMESPACE = 100     # letters; a topic of DDS has at most 255 with all names that follow
COMPRESSIONS = ('none', 'lz4', 'zstd')

RosValue = bool | int | float | str | list[str]


class Kind(Enum):
    """Kind of an option's value."""

    CONFIG = CONFIG
    """Path of a run file, or name of a shipped one."""
    SCENARIO = SCENARIOS
    """Path of a scenario file, or name of a shipped one."""
    PATH = 'path'
    NEW_FILE = 'new file'
    NAMESPACE = 'namespace'
    """Of ROS: names, each below the one before it, separated by slashes."""
    COMPRESSION = 'compression'
    POSITIVE = '> 0'
    NOT_NEGATIVE = '>= 0'
    LIMIT = '>= 0, 0: no limit'
    WHOLE = 'whole number >= 0'
    FLAG = 'flag'
    NAMES = 'names'
    """Names, separated by commas on the command line."""
    REPEATED = 'repeated'
    """One name for each time the option is given on the command line."""
    CHANGES = 'changes'
    """One KEY=VALUE for each time the option is given on the command line."""


SHIPPED = (Kind.CONFIG, Kind.SCENARIO)
"""Kinds whose values may be names of shipped files."""
_LISTS: Mapping[Kind, str] = {
    Kind.NAMES: 'names', Kind.REPEATED: 'names', Kind.CHANGES: 'KEY=VALUE'}
"""Entries of the kinds that are lists."""
_COMMA = {
    kind: re.compile(r',(?=[^,=\[{]+=)' if kind is Kind.CHANGES else ',') for kind in _LISTS}
"""What separates entries in a launch file; the value of a change may have commas too."""
_UNSET: Mapping[Kind, tuple[RosValue, str]] = {
    Kind.POSITIVE: (0.0, '0'), Kind.LIMIT: (0.0, '0'), Kind.NOT_NEGATIVE: (-1.0, '< 0'),
    Kind.WHOLE: (-1, '< 0'), Kind.FLAG: (False, 'false')}
"""Value of a ROS parameter that is not set, and its text in help; other kinds: an empty text."""
_EMPTY: tuple[RosValue, str] = ('', 'empty')
_NAMESPACE = re.compile(r'/?[A-Za-z_][A-Za-z0-9_]*(/[A-Za-z_][A-Za-z0-9_]*)*/?')
_FLAGS = {'true': True, '1': True, 'false': False, '0': False}


@frozen(kw_only=True)
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
        if self.kind in SHIPPED:
            return None if value is None else find(value, self.kind.value)
        if self.kind is Kind.NAMESPACE:
            return namespace(value)
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
        if self.kind in (Kind.POSITIVE, Kind.LIMIT, Kind.NOT_NEGATIVE):
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


def namespace(text: str) -> str:
    """
    Return a namespace of nodes without the slashes around it; '': the root.

    Raises
    ------
    ConfigError
        ROS does not accept it.

    """
    if text.strip('/') and (not _NAMESPACE.fullmatch(text) or '__' in text):
        raise ConfigError(
            f'namespace = {text!r}, must be names of letters, digits and single _, separated by '
            'slashes, none beginning with a digit, for example left or robot1/left')
    own = text.strip('/')
    if len(own) > _LONGEST_NAMESPACE:
        raise ConfigError(
            f'namespace = {own[:20]}... has {len(own)} letters, must have at most '
            f'{_LONGEST_NAMESPACE}')
    return own


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
