"""Messages of supplies and of the parts of circuits: pressures, temperatures of gas and oil."""

from isa_ros.core.topic import Topic
from msg_adapters.coordinator_messages import supply_topic, WORLD_FRAME
from msg_adapters.sensor_messages import (
    fluid_pressure, PRESSURE_TYPE, temperature, TEMPERATURE_TYPE)
from msg_adapters.template import Prepared

SIGNALS = ('pressure', 'return_pressure', 'gas_temperature', 'oil_temperature')
"""Fields of a `SUPPLY_SAMPLE` that may have a topic, in the order of their columns."""


def of_supply(supply: str, signal: str, first: int) -> tuple[Topic, Prepared]:
    """Return topic and message of one of `SIGNALS`, whose columns begin at ``first``."""
    column = first + SIGNALS.index(signal)
    if signal.endswith('_temperature'):
        return (Topic(supply_topic(supply, signal), TEMPERATURE_TYPE),
                temperature(WORLD_FRAME, column))
    return Topic(supply_topic(supply, signal), PRESSURE_TYPE), fluid_pressure(WORLD_FRAME, column)
