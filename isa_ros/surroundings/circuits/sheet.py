"""
A circuit as its file has it: named parts, and what stands between which of them.

Manifolds and the tank are the places; every other part stands between two of them, or on one.
"""

from collections.abc import Iterator, Mapping
from dataclasses import fields

from isa_ros.core.frozen import frozen
from isa_ros.core.parameter import fault, named_sets, Parameters, section
from isa_ros.core.suggest import alternatives
from isa_ros.core.units import MPA
from isa_ros.errors import ParameterError
from isa_ros.surroundings.circuits.accumulator import AccumulatorPart
from isa_ros.surroundings.circuits.check import CheckPart
from isa_ros.surroundings.circuits.heat import CoolerPart, NoneHeat, TankHeat
from isa_ros.surroundings.circuits.line import LinePart
from isa_ros.surroundings.circuits.manifold import ManifoldPart, TankPart
from isa_ros.surroundings.circuits.oil import CircuitOil
from isa_ros.surroundings.circuits.orifice import (
    BlockPart, DumpPart, SwitchedPart, UnloadingPart)
from isa_ros.surroundings.circuits.pump import PumpPart
from isa_ros.surroundings.circuits.relief import FilterPart, ReliefPart
from isa_ros.surroundings.return_line import HeldReturn, ReturnLine

Part = (TankPart | ManifoldPart | PumpPart | AccumulatorPart | LinePart | ReliefPart | CheckPart
        | FilterPart | UnloadingPart | BlockPart | DumpPart | CoolerPart)
Between = (PumpPart | LinePart | ReliefPart | CheckPart | FilterPart | UnloadingPart | BlockPart
           | DumpPart)
"""Those with an inlet and an outlet."""


@frozen(kw_only=True)
class SwitchedCurrent(Parameters):
    """The current of all pumps and valves of a circuit, which the emergency stop takes."""

    opened: float = fault(
        '1: pumps and valves of the circuit have no current', '1', is_whole=True, ge=0.0, le=1.0)


@frozen(kw_only=True)
class CircuitSupply(Parameters):
    """A circuit of named parts: pumps, lines, valves and accumulators between manifolds."""

    oil: CircuitOil = section(CircuitOil)
    parts: Parameters = named_sets(Part)
    dump: SwitchedCurrent = section(SwitchedCurrent)

    def __post_init__(self) -> None:
        super().__post_init__()
        refuse_parts(self.by_name)

    @property
    def by_name(self) -> Mapping[str, Part]:
        """Return its parts by name, in their order."""
        return {f.name: getattr(self.parts, f.name) for f in fields(self.parts)}

    @property
    def between(self) -> Mapping[str, Between]:
        """Return those of its parts that have an inlet and an outlet."""
        return {name: part for name, part in self.by_name.items() if isinstance(part, Between)}

    @property
    def tank(self) -> str:
        """Return the name of its tank."""
        return next(_named(self.by_name, TankPart))

    @property
    def heat(self) -> TankHeat:
        """Return the heat of its tank."""
        return next(part.heat for part in self.by_name.values() if isinstance(part, TankPart))

    @property
    def pressure_mpa(self) -> float:
        """Return the greatest set pressure of its pumps above the tank's."""
        return max(part.pressure_mpa for part in self.by_name.values()
                   if isinstance(part, PumpPart)) + self.return_pressure_mpa

    @property
    def rest_pressure(self) -> float:
        """Return what its pumps hold, or a relief or unloading valve less of it, Pa gauge."""
        tank = self.return_pressure_mpa * MPA
        return min([self.pressure_mpa * MPA, *(
            part.opens_mpa * MPA + tank * isinstance(part, ReliefPart)
            for part in self.by_name.values() if isinstance(part, ReliefPart | UnloadingPart))])

    @property
    def return_pressure_mpa(self) -> float:
        """Return the pressure of its tank."""
        return next(part.pressure_mpa for part in self.by_name.values()
                    if isinstance(part, TankPart))

    @property
    def return_line(self) -> ReturnLine:
        """Return what stands for its return side elsewhere: its parts have it."""
        return HeldReturn()

    @property
    def is_switched(self) -> bool:
        """Return whether the emergency stop takes its current: it has a valve for that."""
        return any(isinstance(part, SwitchedPart) for part in self.by_name.values())

    def return_of(self, manifold: str) -> str:
        """Return the place to which the actuators on a manifold return their oil."""
        part = self.by_name[manifold]
        return isinstance(part, ManifoldPart) and part.returns_to or self.tank

    def with_return(self) -> frozenset[str]:
        """Return the manifolds between what actuators return and the tank."""
        found = {self.return_of(name) for name in _named(self.by_name, ManifoldPart)}
        while True:
            beyond = found | {part.outlet for part in self.between.values()
                              if part.inlet in found - {self.tank}}
            if beyond == found:
                return frozenset(found - {self.tank})
            found = beyond


def _named(parts: Mapping[str, Part], *kinds: type[Parameters]) -> Iterator[str]:
    return (name for name, part in parts.items() if isinstance(part, kinds))


def refuse_parts(parts: Mapping[str, Part]) -> None:
    """
    Refuse parts that do not make a circuit.

    Raises
    ------
    ParameterError
        There is not one tank, or no pump; or a place that a part names is none, is its own, or
        is taken.

    """
    tanks, manifolds = list(_named(parts, TankPart)), list(_named(parts, ManifoldPart))
    if len(tanks) != 1:
        raise ParameterError(f'parts has {len(tanks)} tanks, must have one part of kind tank')
    if not list(_named(parts, PumpPart)):
        raise ParameterError('parts lacks a pump, must have at least one')
    places = [*manifolds, *tanks]
    for name, part in parts.items():
        for key, among in (('inlet', places), ('outlet', places), ('at', manifolds),
                           ('senses', manifolds), ('returns_to', places)):
            given = getattr(part, key, None)
            if given is not None and given not in among and (key, given) != ('returns_to', ''):
                kinds = 'a manifold' if among is manifolds else 'a manifold or the tank'
                raise ParameterError(f'parts.{name}.{key} = {given!r}, must be {kinds}; '
                                     f'{alternatives(given, among)}')
        if isinstance(part, Between) and part.inlet == part.outlet:
            raise ParameterError(
                f'parts.{name}.outlet = {part.outlet!r}, must be another one than its inlet')
        if isinstance(part, PumpPart) and part.outlet in tanks:
            raise ParameterError(f'parts.{name}.outlet = {part.outlet!r}, must be the manifold '
                                 f'that it feeds, of {", ".join(manifolds)}')
        if isinstance(part, ManifoldPart) and part.returns_to == name:
            raise ParameterError(
                f'parts.{name}.returns_to = {name!r}, must be another manifold or the tank')
    _refuse_alone(parts, manifolds)
    _refuse_unfed(parts, manifolds)
    _refuse_coolers(parts, tanks[0])


def _refuse_coolers(parts: Mapping[str, Part], tank: str) -> None:
    """Refuse a cooler of oil whose temperature stays as it is."""
    own = parts[tank]
    if isinstance(own, TankPart) and isinstance(own.heat, NoneHeat):
        for name in _named(parts, CoolerPart):
            raise ParameterError(
                f'parts.{name}: the oil has no heat to give; parts.{tank}.heat.kind must be mixed')


def _refuse_alone(parts: Mapping[str, Part], manifolds: list[str]) -> None:
    """Refuse two accumulators on one manifold, and a manifold that nothing is connected to."""
    taken: dict[str, str] = {}
    for name, part in parts.items():
        if isinstance(part, AccumulatorPart):
            if part.at in taken:
                raise ParameterError(
                    f'parts.{name}.at = {part.at!r}, where {taken[part.at]} stands; must be '
                    'another manifold, perhaps behind a line')
            taken[part.at] = name
    for name in manifolds:
        if not any(isinstance(part, Between) and name in (part.inlet, part.outlet)
                   for part in parts.values()):
            raise ParameterError(f'parts.{name}: no part leads to this manifold')


def _refuse_unfed(parts: Mapping[str, Part], manifolds: list[str]) -> None:
    """
    Refuse manifolds that no oil comes to, from the tank or from what actuators return.

    It flows from inlets to outlets; lines, filters and block valves let it through both ways.
    """
    found = {*_named(parts, TankPart), *(
        part.returns_to for part in parts.values() if isinstance(part, ManifoldPart))}
    ways = [(part.inlet, part.outlet) for part in parts.values() if isinstance(part, Between)]
    ways += [(part.outlet, part.inlet) for part in parts.values()
             if isinstance(part, LinePart | FilterPart | BlockPart)]
    while beyond := {outlet for inlet, outlet in ways if inlet in found} - found:
        found |= beyond
    for name in manifolds:
        if name not in found:
            raise ParameterError(
                f'parts.{name}: no part leads oil to this manifold, which begins with it; oil '
                'flows from inlet to outlet')
