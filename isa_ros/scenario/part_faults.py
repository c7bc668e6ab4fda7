"""
Faults of the parts of a circuit, by the key ``part`` of a fault of a scenario.

    - {t_s: 0.6, supply: station, part: buffer, fault: accumulator_empty}
    - {t_s: 0.6, supply: station, part: press_hose, set: {burst: 0.2}}

The second is short for ``set: {parts.press_hose.burst: 0.2}``. A named fault needs no ``part``
where the circuit has only one of its kind.
"""

from isa_ros.config.models.fault_catalogue import NamedFault
from isa_ros.config.text.parameter_sets import kind_of
from isa_ros.config.text.sections import Place
from isa_ros.config.text.yaml_text import Tree
from isa_ros.core.suggest import alternatives
from isa_ros.errors import ConfigError
from isa_ros.surroundings.circuits.sheet import CircuitSupply, Part
from isa_ros.surroundings.supply import SupplySheet

PART = 'part'


def supply_values(
        fault: NamedFault, supply: SupplySheet, tree: Tree, place: Place) -> dict[str, float]:
    """
    Return the values of a named fault of a supply by key, of a circuit those of one part.

    Raises
    ------
    ConfigError
        The supply is a circuit that has no such part, or several, or it is none and only a circuit
        has the fault.

    """
    if isinstance(supply, CircuitSupply) and fault.part:
        chosen = _chosen(fault, supply, tree, place)
        return values_of_part(fault, chosen)
    part_prefix(supply, tree, place)
    if not fault.values:
        raise ConfigError(
            f'{place}.fault = {fault.name!r} is one of a part of kind {fault.part}, must be one '
            f'of a supply of kind {kind_of(supply, SupplySheet)}')
    return dict(fault.values)


def values_of_part(fault: NamedFault, part: str) -> dict[str, float]:
    """Return the values of a fault of a part by the keys of its circuit."""
    return {f'parts.{part}.{key}': value for key, value in fault.part_values.items()}


def parts_with(fault: NamedFault, supply: CircuitSupply) -> list[str]:
    """Return the names of the parts of a circuit that may have a fault."""
    return [name for name, part in supply.by_name.items() if kind_of(part, Part) == fault.part]


def part_prefix(supply: SupplySheet | None, tree: Tree, place: Place) -> str:
    """Return what the keys of the given part begin with, '' without; raises as `supply_values`."""
    if PART not in tree:
        return ''
    if not isinstance(supply, CircuitSupply):
        raise ConfigError(f'{place / PART} is not used: only a supply that is a circuit has parts')
    name = tree[PART]
    if name not in supply.by_name:
        raise ConfigError(
            f'{place / PART} = {name!r} is unknown; {alternatives(str(name), supply.by_name)}')
    return f'parts.{name}.'


def _chosen(fault: NamedFault, supply: CircuitSupply, tree: Tree, place: Place) -> str:
    """Return the name of the part that has a fault: the given one, or the only one."""
    fitting = parts_with(fault, supply)
    if not fitting:
        raise ConfigError(
            f'{place}.fault = {fault.name!r} is one of a part of kind {fault.part}, of which the '
            'circuit has none')
    if part_prefix(supply, tree, place):
        name = str(tree[PART])
        if name not in fitting:
            raise ConfigError(
                f'{place / PART} = {name!r} is of kind {kind_of(supply.by_name[name], Part)}, '
                f'must be of kind {fault.part} for {fault.name!r}: {", ".join(fitting)}')
        return name
    if len(fitting) > 1:
        raise ConfigError(place.has(
            f'lacks {PART}: {fault.name!r} is one of a part of kind {fault.part}, of which the '
            f'circuit has {", ".join(fitting)}'))
    return fitting[0]
