"""A sample as a table of its fields, from which its record type and its units are made."""

from collections.abc import Sequence
from typing import NamedTuple

from isa_ros.core.units import of_coordinate
import numpy as np


class Field(NamedTuple):
    """One field of a sample: a float, or several in a row."""

    name: str
    unit: str
    """SI; of a linear actuator ``|`` of a rotary one where they differ."""
    meaning: str
    shape: tuple[int, ...] = ()


def record_type(fields: Sequence[Field]) -> np.dtype[np.void]:
    """Return the type of a record with these fields, little endian."""
    return np.dtype([(field.name, '<f8', field.shape) for field in fields])


def units_of(fields: Sequence[Field], is_rotary: bool = False) -> dict[str, str]:
    """Return the unit of each field by name, of a linear or a rotary actuator."""
    return {field.name: of_coordinate(field.unit, is_rotary) for field in fields}
