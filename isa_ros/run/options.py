"""
The options of a run, each declared once: a field of `Request`.

The arguments of `isa bringup`, the ROS parameters of the coordinator and the arguments of the
launch file are made from `OPTIONS`, and `Request` is filled from their values. This module
imports neither ROS nor numba: `isa --help` and launch files import it.
"""

from collections.abc import Mapping, Sequence
from dataclasses import field, fields, MISSING, replace
from pathlib import Path
from typing import Any

from isa_ros.core.frozen import frozen
from isa_ros.run.option import Kind, Option, RosValue, SHIPPED
from isa_ros.run.pacing import JOIN_TIMEOUT_S, Laps

SET_HELP = (
    'another value in {config}, by its key and in its unit, as isa params shows them; keys of the '
    'scenario begin with scenario.')


def _option(kind: Kind, meaning: str, **more: Any) -> Mapping[str, Option]:
    return {'option': Option(kind=kind, meaning=meaning, **more)}


@frozen(kw_only=True)
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
    start_time_s: int | None = field(default=None, metadata=_option(
        Kind.WHOLE, 'time of all stamps at t = 0, since 1970', unit='s', metavar='S',
        otherwise='that of {config}', name='start_time'))
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
        Kind.LIMIT, 'not faster than X times real time', otherwise='as fast as possible',
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
    fail_on_trip: bool = field(default=False, metadata=_option(
        Kind.FLAG, 'end with exit code 1 if a condition of an actuator has tripped'))
    is_paused: bool = field(default=False, metadata=_option(
        Kind.FLAG, 'wait before tick 0 for /coordinator/step or the end of the pause',
        name='paused'))
    restore: Path | None = field(default=None, metadata=_option(
        Kind.PATH, 'continue from a saved state', metavar='FILE'))
    save: Path | None = field(default=None, metadata=_option(
        Kind.NEW_FILE, 'save the state at the end to a file', metavar='FILE'))
    namespace: str = field(default='', metadata=_option(
        Kind.NAMESPACE, 'of all nodes and topics; a domain may have one run in each',
        metavar='NAME', is_parameter=False))
    is_alone: bool = False
    """Whether this process does nothing but the run: then the loaded objects need no garbage
    collection and, if the process has had no node yet, actuator processes may be forked."""
    laps: Laps | None = None
    """Measures the host time of every phase of the ticks."""

    @property
    def all_changes(self) -> tuple[str, ...]:
        """Return `changes`, then those of options that are keys of a run file."""
        return all_changes(self.changes, self.seed, self.start_time_s)


def all_changes(
        changes: Sequence[str], seed: int | None, start_time_s: int | None) -> tuple[str, ...]:
    """Return the changes of a request, then its seed and start, as far as it has them."""
    keys = {'seed': seed, 'start_time_s': start_time_s}
    return (*changes, *(f'{key}={value}' for key, value in keys.items() if value is not None))


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
              if option.is_parameter and option.kind not in SHIPPED}
    return {name: value for name, value in values.items() if value != []}


def launched_elsewhere(texts: Mapping[str, str]) -> tuple[str, ...]:
    """Return the actuators that a launch file does not start."""
    return tuple(text for text in texts['elsewhere'].split(',') if text)
