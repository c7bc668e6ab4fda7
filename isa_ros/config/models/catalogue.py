"""The data that comes with the package: actuator models, legs, materials, gaits, wires."""

from collections.abc import Sequence
from functools import cache
from pathlib import Path

from isa_ros.config.text.sections import (
    entry_at, merge, names_at, Place, refuse_unknown, Section, section_at, sourced, SourcedValue)
from isa_ros.config.text.yaml_text import read, Tree
from isa_ros.core.frozen import frozen
from isa_ros.core.suggest import alternatives, listed
from isa_ros.errors import ConfigError

_DATA = Path(__file__).parents[1] / 'data'
_MODELS = _DATA / 'models'
_LEGS = _DATA / 'legs'
_MATERIALS = _DATA / 'materials'
_GAITS = _DATA / 'gaits'
_WIRES = _DATA / 'wires'
DEFAULT_PRESET = 'default'
_PAD_KEYS = ('stiffness', 'damping')  # of the material, used by a pad


@frozen
class Model:
    """One actuator model: its sheet without REU gains, gain sets, variants and own loads."""

    name: str
    place: Place
    sheet: Section
    presets: dict[str, Section]
    variants: dict[str, Section]
    """Other ways to model or to wire it: sections that replace those of the sheet."""
    loads: dict[str, Section]
    default_load: str
    stated: tuple[str, ...] = ()
    """Dotted keys of the sheet that a run file must state: those of the user's data sheets."""

    def with_preset(self, preset: str, where: str) -> Section:
        """
        Return the whole sheet with the gains of a preset.

        Raises
        ------
        ConfigError
            The model has no preset of this name; ``where`` is the key with the name.

        """
        if preset not in self.presets:
            raise ConfigError(
                f'{where} = {preset!r} is not a preset of {self.name}; '
                f'{alternatives(preset, self.presets)}')
        return merge(self.sheet, {'reu': self.presets[preset]})

    def with_variants(self, section: Section, variants: Sequence[str], where: str) -> Section:
        """
        Return a sheet with some sections replaced by those of variants, in their order.

        Raises
        ------
        ConfigError
            The model has no variant of a name; ``where`` is the key with the name.

        """
        for variant in variants:
            if variant not in self.variants:
                raise ConfigError(
                    f'{where} = {variant!r} is not a variant of {self.name}; '
                    f'{alternatives(str(variant), self.variants)}')
            section = merge(section, self.variants[variant])
        return section

    def refuse_unstated(self, own: Section, base: Section, place: Place) -> None:
        """
        Refuse a sheet that has values of `stated` from ``base``, of the model, at ``place``.

        Raises
        ------
        ConfigError
            The run file leaves a value out that belongs to its own cylinder or valve.

        """
        lacking = [key for key in self.stated
                   if (entry := entry_at(own, key)) is not None and entry is entry_at(base, key)]
        if lacking:
            raise ConfigError(place.has(
                f'lacks {listed(lacking)}: {self.name} has none of its own, see your data sheets'
                + ''.join(_misspelled(own, base, key) for key in lacking)))


def _misspelled(own: Section, base: Section, key: str) -> str:
    """Return a hint for a key that lacks, if a name that is not the model's stands for it."""
    below, _, name = key.rpartition('.')
    there, known = entry_at(own, below), entry_at(base, below)
    if not isinstance(there, dict) or not isinstance(known, dict):
        return ''
    return ''.join(
        f'; {other}: {hint}' for other in there if other not in known
        and (hint := alternatives(other, [name])).startswith(('did you mean', 'the key is')))


def model_names() -> list[str]:
    """Return the names of the packaged actuator models, sorted."""
    return _names(_MODELS)


def leg_names() -> list[str]:
    """Return the names of the packaged legs, sorted."""
    return _names(_LEGS)


def actuator_model(name: str, where: str) -> Model:
    """
    Return a packaged actuator model; ``where`` is the key with its name.

    Raises
    ------
    ConfigError
        The model does not exist, or its file is invalid.

    """
    return _model(_packaged(_MODELS, name, where, 'model'))


@cache
def _model(path: Path) -> Model:
    """Return the model of a file; sections are merged by copies, so that one serves all."""
    return model_of(read(path), path.name)


def model_of(tree: Tree, file: str) -> Model:
    """Return the model of a file's tree; as `actuator_model`."""
    place = Place(file)
    refuse_unknown(
        tree, ('model', 'kind', 'stated', 'spool_feedback', 'plant', 'reu', 'presets', 'variants',
               'loads'), place)
    sheet = sourced(
        {key: tree[key] for key in ('spool_feedback', 'plant', 'reu') if key in tree}, place)
    plant = sheet.get('plant')
    if isinstance(plant, dict):
        plant['kind'] = SourcedValue(str(tree.get('kind')), str(place / 'kind'), '')
    loads = section_at(tree.get('loads'), place / 'loads')
    default = loads.pop('default', None)
    if not isinstance(default, str) or default not in loads:
        raise ConfigError(f'{place}: loads.default = {default!r}; {alternatives("", loads)}')
    return Model(
        file.removesuffix('.yaml'), place, sheet,
        _sections(section_at(tree.get('presets'), place / 'presets'), place / 'presets'),
        _sections(section_at(tree.get('variants', {}), place / 'variants'), place / 'variants'),
        {load: _load(load, section_at(below, place / 'loads' / load), place / 'loads' / load)
         for load, below in loads.items()}, str(default),
        tuple(names_at(tree.get('stated', []), place / 'stated')))


def _sections(tree: Tree, place: Place) -> dict[str, Section]:
    return {name: sourced(section_at(below, place / name), place / name)
            for name, below in tree.items()}


def _load(name: str, tree: Tree, place: Place) -> Section:
    """Return a load with its kind; without a key ``kind`` that is its name."""
    rest = {key: value for key, value in tree.items() if key != 'material'}
    section = {'kind': SourcedValue(name, str(place), '')} | sourced(rest, place)
    if 'material' in tree:
        material, _ = material_section(tree['material'], f'{place}.material')
        section = {key: material[key] for key in _PAD_KEYS} | section
    return section


def leg_section(name: str, where: str) -> tuple[Section, Place]:
    """Return the sheet of a packaged leg; as `actuator_model`."""
    return _sourced(_packaged(_LEGS, name, where, 'leg'))


@cache
def _sourced(path: Path) -> tuple[Section, Place]:
    """Return the values of a file, and its name; as `_model`."""
    return sourced(read(path), Place(path.name)), Place(path.name)


def material_section(name: object, where: str) -> tuple[Section, Place]:
    """Return a packaged material as the section of a ground; as `actuator_model`."""
    return _sourced(_packaged(_MATERIALS, name, where, 'material'))


def wire_section(name: object, where: str) -> tuple[Section, Place]:
    """Return a packaged wire of links; as `actuator_model`."""
    return _sourced(_packaged(_WIRES, name, where, 'wire'))


def gait_section(name: str, where: str) -> Section:
    """Return the values of a packaged gait; as `actuator_model`."""
    return _sourced(_packaged(_GAITS, name, where, 'gait'))[0]


def _names(directory: Path) -> list[str]:
    return sorted(path.stem for path in directory.glob('*.yaml'))


def _packaged(directory: Path, name: object, where: str, what: str) -> Path:
    names = _names(directory)
    if not isinstance(name, str) or name not in names:
        raise ConfigError(f'{where} = {name!r} is not a {what}; {alternatives(str(name), names)}')
    return directory / f'{name}.yaml'
