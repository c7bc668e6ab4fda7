"""Single parameters of an actuator replaced by dotted path, where no run file is at hand."""

from collections.abc import Mapping
from dataclasses import fields, replace
from typing import Any

from isa_ros.config.runs.run_config import ActuatorConfig
from isa_ros.core.parameter import Parameters
from isa_ros.core.suggest import alternatives
from isa_ros.errors import ConfigError, ParameterError

Values = Mapping[str, Any]
"""Values in data-sheet units by dotted path: plant..., reu... or load...."""


def with_parameters(actuator: ActuatorConfig, values: Values, where: str) -> ActuatorConfig:
    """
    Return an actuator with single parameters, or whole sections, replaced.

    ``where`` is the name of its file for messages.

    Raises
    ------
    ConfigError
        There is no such parameter, or the value is outside its range.

    """
    for path, value in values.items():
        actuator = _changed(actuator, path, value, f'{where}: {actuator.name}')
    return actuator


def _changed(actuator: ActuatorConfig, path: str, value: Any, where: str) -> ActuatorConfig:
    head, _, rest = path.partition('.')
    try:
        if head == 'load' and isinstance(actuator.load, Parameters):
            return replace(actuator, load=_replaced(
                actuator.load, rest, value, f'{where}.{head}'))
        return replace(actuator, sheet=_replaced(actuator.sheet, path, value, where))
    except ParameterError as error:
        raise ParameterError(f'{where}.{path}: {error}') from error


def _replaced(parameters: Any, path: str, value: Any, where: str) -> Any:
    head, _, rest = path.partition('.')
    names = [f.name for f in fields(parameters)]
    if head not in names:
        raise ConfigError(f'{where}.{head} is unknown; {alternatives(head, names)}')
    if rest:
        below = getattr(parameters, head)
        if not isinstance(below, Parameters):
            raise ConfigError(f'{where}.{head} is one value, has no {rest}')
        value = _replaced(below, rest, value, f'{where}.{head}')
    return replace(parameters, **{head: value})
