"""Packaged leg data sheets: YAML trees of ``{value, source}`` and what is built from them."""

from collections.abc import Mapping
from dataclasses import fields
from importlib import resources
from typing import Any, TypeVar

from isa_ros.errors import ConfigError
from isa_ros.load.ground import Ground
from isa_ros.load.leg_sheet import (
    Body, Direct, FourBar, JOINTS, LegSheet, Link, Slider, SliderCrank)
from isa_ros.parameter import Parameters
import yaml

LINKAGES = {'direct': Direct, 'slider_crank': SliderCrank, 'four_bar': FourBar}
Tree = Mapping[str, Any]
SheetT = TypeVar('SheetT', bound=Parameters)


def packaged_legs() -> tuple[str, ...]:
    """Return the names of the packaged legs, sorted."""
    return tuple(sorted(
        path.name.removesuffix('.yaml')
        for path in resources.files('isa_ros.load').joinpath('legs').iterdir()
        if path.name.endswith('.yaml')))


def leg_tree(name: str) -> Tree:
    """
    Return a packaged leg as its tree of ``{value, source}`` leaves.

    Raises:
        ConfigError: no packaged leg has this name.

    """
    if name not in packaged_legs():
        raise ConfigError(f'leg = {name!r}, must be one of {", ".join(packaged_legs())}')
    path = resources.files('isa_ros.load').joinpath('legs', f'{name}.yaml')
    tree: Tree = yaml.safe_load(path.read_text(encoding='utf-8'))
    return tree


def values(tree: Tree) -> dict[str, Any]:
    """Return the tree with every ``{value, source}`` leaf replaced by its value."""
    plain: dict[str, Any] = {}
    for key, entry in tree.items():
        if isinstance(entry, Mapping):
            plain[key] = entry['value'] if set(entry) == {'value', 'source'} else values(entry)
        else:
            plain[key] = entry
    return plain


def leg_sheet(plain: Tree) -> LegSheet:
    """
    Build a sheet from a tree of plain values.

    Raises:
        ConfigError: a key is missing or unknown, a linkage has no such kind, or a value is
            outside its range.

    """
    sections = dict(plain)
    body = dict(_section(sections, 'body', 'leg'))
    for name, kind in (('slider', Slider), ('hip', Link), ('thigh', Link), ('calf', Link)):
        body[name] = _build(kind, _section(body, name, 'leg.body'), f'leg.body.{name}')
    sections['body'] = _build(Body, body, 'leg.body')
    for name in JOINTS:
        joint = dict(_section(sections, name, 'leg'))
        kind = joint.pop('linkage', None)
        if kind not in LINKAGES:
            raise ConfigError(
                f'leg.{name}.linkage = {kind!r}, must be one of {", ".join(LINKAGES)}')
        sections[name] = _build(LINKAGES[kind], joint, f'leg.{name}')
    sections['ground'] = _build(Ground, _section(sections, 'ground', 'leg'), 'leg.ground')
    return _build(LegSheet, sections, 'leg')


def packaged_leg(name: str) -> LegSheet:
    """Return the sheet of a packaged leg."""
    return leg_sheet(values(leg_tree(name)))


def _section(tree: Tree, name: str, where: str) -> Tree:
    section = tree.get(name)
    if not isinstance(section, Mapping):
        raise ConfigError(f'{where}.{name} = {section!r}, must be a section of keys')
    return section


def _build(kind: type[SheetT], entries: Tree, where: str) -> SheetT:
    names = [f.name for f in fields(kind)]
    for key in entries:
        if key not in names:
            raise ConfigError(f'{where}.{key}: unknown key, must be one of {", ".join(names)}')
    for name in names:
        if name not in entries:
            raise ConfigError(f'{where}.{name}: missing key')
    return kind(**entries)
