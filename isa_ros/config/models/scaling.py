"""
The values of a model that scale with its cylinder, its valve or its supply.

A value written with ``scales_with`` holds for the model as it is, at `PAPER_SUPPLY`. For a run
file with another bore, valve or supply it is multiplied by the ratio of that quantity; a value
that the file has itself is not.
"""

from dataclasses import dataclass, field, replace
from typing import Any

from isa_ros.actuator.actuator import PAPER_SUPPLY
from isa_ros.actuator.scales import SCALES
from isa_ros.actuator.sheet import ActuatorSheet
from isa_ros.config.text.parameter_sets import build
from isa_ros.config.text.sections import Place, Section, SourcedValue
from isa_ros.errors import ConfigError


@dataclass(frozen=True)
class Scaling:
    """A model as it is, and an actuator made from it."""

    model: ActuatorSheet
    own: ActuatorSheet
    supply: float
    """Supply above return pressure of the actuator, Pa."""
    _factors: dict[str, float] = field(default_factory=dict, init=False, repr=False, compare=False)
    """The ratios so far: several values scale with one quantity, and some take long to compute."""

    def factor(self, scale: str) -> float:
        """
        Return the ratio of a quantity.

        Raises
        ------
        ConfigError
            The actuator does not have the quantity.

        """
        if scale not in self._factors:
            quantity = SCALES[scale]
            self._factors[scale] = (
                quantity(self.own, self.supply) / quantity(self.model, PAPER_SUPPLY))
        return self._factors[scale]

    def section(self, section: Section, place: Place) -> Section:
        """Return a section with its values scaled; ``place`` is where a file would have them."""
        scaled: Section = {}
        for key, entry in section.items():
            if isinstance(entry, SourcedValue):
                scaled[key] = self._entry(entry, place / key)
            else:
                scaled[key] = self.section(entry, place / key)
        return scaled

    def _entry(self, entry: SourcedValue, place: Place) -> SourcedValue:
        if not entry.scales_with:
            return entry
        try:
            factor = self.factor(entry.scales_with)
        except ConfigError as error:
            raise ConfigError(f'{place}: {error}') from error
        if factor == 1.0:
            return entry
        scaled = f'scaled with {entry.scales_with}'
        return replace(
            entry, value=_times(entry.value, factor), where=f'{place} ({scaled})',
            source=f'{entry.source}; {scaled}', scales_with='')


def _times(value: Any, factor: float) -> Any:
    return [one * factor for one in value] if isinstance(value, list) else value * factor


def scaled_sheet(
        section: Section, model: Section, model_place: Place, place: Place,
        supply: float) -> tuple[ActuatorSheet, Section]:
    """
    Return the sheet of an actuator, and its section with scaled values.

    ``section`` is that of the ``model`` with values replaced at ``place``. Values of the plant
    are scaled first: those of the REU may depend on them.

    Raises
    ------
    ConfigError
        As `isa_ros.config.text.parameter_sets.build`, or a scaled value is out of its range.

    """
    base = build(ActuatorSheet, model, model_place)
    own = base if section == model else build(ActuatorSheet, section, model_place)
    if own == base and supply == PAPER_SUPPLY:
        return own, section
    for part in ('plant', 'reu'):
        below = section[part]
        assert not isinstance(below, SourcedValue)
        scaling = Scaling(base, own, supply)
        section = section | {part: scaling.section(below, place / part)}
        own = build(ActuatorSheet, section, model_place)
    return own, section
