"""
The values of a model that scale with the rated data of its cylinder and valve.

A value written with ``scales_with`` holds for the model as it is. For a run file with another
bore, rated pressure or valve it is multiplied by the ratio of that quantity; a value that the file
has itself is not. Rated data are the sections `RATED` of the plant and which blocks the REU has.
Nothing follows the supply of the run, its oil, its sensors or the rates of its blocks: a sweep of
one of them is of the same actuator.
"""

from dataclasses import field, replace
from typing import Any

from isa_ros.actuator.scales import keys_of, SCALES
from isa_ros.actuator.sheet import ActuatorSheet
from isa_ros.config.text.parameter_sets import build
from isa_ros.config.text.sections import Place, Section, SourcedValue
from isa_ros.core.frozen import frozen
from isa_ros.core.remembered import remembered
from isa_ros.errors import ConfigError

RATED = ('kind', 'drive', 'coil', 'spool', 'valve', 'return_spring')
"""Entries of the plant with rated data."""


@frozen
class Scaling:
    """A model as it is, and one with the rated data of an actuator made from it."""

    model: ActuatorSheet
    own: ActuatorSheet
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
            self._factors[scale] = quantity(self.own) / quantity(self.model)
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
        why = f"{scaled}: {factor:.3g} times the model's, by {keys_of(entry.scales_with)}"
        return replace(
            entry, value=_times(entry.value, factor), where=f'{place} ({why})',
            source=f'{entry.source}; {scaled}', scales_with='')


def _times(value: Any, factor: float) -> Any:
    return [one * factor for one in value] if isinstance(value, list) else value * factor


def scaled_sheet(
        section: Section, model: Section, model_place: Place, place: Place
        ) -> tuple[ActuatorSheet, Section]:
    """
    Return the sheet of an actuator, and its section with scaled values.

    ``section`` is that of the ``model`` with values replaced at ``place``. Values of the plant
    are scaled first: those of the REU may depend on them.

    Raises
    ------
    ConfigError
        As `isa_ros.config.text.parameter_sets.build`, or a scaled value is out of its range.

    """
    base = _model_sheet(model, model_place)
    own = base if section == model else build(
        ActuatorSheet, section, model_place, base.is_rotary)
    if own == base:
        return own, section
    rated = _rated(section, model)
    if rated == model:      # all ratios are 1
        return own, section
    for part in ('plant', 'reu'):
        scaling = Scaling(base, build(ActuatorSheet, rated, model_place))
        section, rated = ({**one, part: scaling.section(_below(one, part), place / part)}
                          for one in (section, rated))
    return build(ActuatorSheet, section, model_place, own.is_rotary), section


@remembered
def _model_sheet(section: Section, place: Place) -> ActuatorSheet:
    """Return the sheet of a model, the same for all runs with it."""
    return build(ActuatorSheet, section, place)


def _rated(section: Section, model: Section) -> Section:
    """Return a section with all else than its rated data as the model has it."""
    plant, reu = _below(section, 'plant'), _below(section, 'reu')
    return section | {
        'plant': _below(model, 'plant') | {key: plant[key] for key in RATED if key in plant},
        'reu': {name: _at_rate_of(own, _below(model, 'reu').get(name))
                for name, own in reu.items()}}


def _at_rate_of(
        block: SourcedValue | Section,
        model: SourcedValue | Section | None) -> SourcedValue | Section:
    """Return a block of the REU at the rate that the model's block in its place has."""
    if isinstance(block, SourcedValue) or not isinstance(model, dict):
        return block
    return block | {key: model[key] for key in ('rate_hz',) if key in block and key in model}


def _below(section: Section, part: str) -> Section:
    below = section[part]
    assert not isinstance(below, SourcedValue)
    return below
