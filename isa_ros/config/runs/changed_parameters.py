"""Single parameters of an actuator replaced by dotted path, where no run file is at hand."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from isa_ros.config.runs.run_config import ActuatorConfig
from isa_ros.core.parameter import Parameters, replaced
from isa_ros.errors import ParameterError

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
    where = f'{where}: {actuator.name}.'
    for path, value in values.items():
        head, _, rest = path.partition('.')
        try:
            if head == 'load' and isinstance(actuator.load, Parameters):
                load = replaced(actuator.load, rest, value, f'{where}{head}.')
                actuator = replace(actuator, load=load)
            else:
                actuator = replace(actuator, sheet=replaced(actuator.sheet, path, value, where))
        except ParameterError as error:
            raise ParameterError(f'{where}{path}: {error}') from error
    return actuator
