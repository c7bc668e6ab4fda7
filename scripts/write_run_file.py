"""
Write the tables of docs/run_file.md from the rows of the keys of a run file.

    python scripts/write_run_file.py
"""

from collections.abc import Iterator, Mapping
from dataclasses import fields
from pathlib import Path
from types import MappingProxyType

from isa_ros.actuator.link import LinkSheet
from isa_ros.config.robots.contacts import CONTACT
from isa_ros.config.robots.drives import DRIVE, Linkage
from isa_ros.config.robots.start import RobotStartValues, START
from isa_ros.config.runs.actuator_config import ACTUATOR
from isa_ros.config.runs.emergency_stops import GROUP
from isa_ros.config.runs.external_config import ExternalConfig
from isa_ros.config.runs.leg_config import LegConfig, LegStart
from isa_ros.config.runs.publishing import PUBLISH_KEYS
from isa_ros.config.runs.recording import RECORD, Storage
from isa_ros.config.runs.robot_config import RobotConfig
from isa_ros.config.runs.run_config import RUN
from isa_ros.config.runs.supplies import SUPPLY_KEYS
from isa_ros.config.text.key_tables import KeyTable
from isa_ros.config.text.keys import InText, parameter_rows, REQUIRED
from isa_ros.config.text.parameter_sets import members
from isa_ros.core.oil_properties import MineralOil
from isa_ros.core.parameter import Parameters
from isa_ros.surroundings.bodies.leg.inertial import Imu
from isa_ros.surroundings.circuits.heat import TankHeat
from isa_ros.surroundings.circuits.line import Wall
from isa_ros.surroundings.circuits.oil import CircuitOil
from isa_ros.surroundings.circuits.sheet import Part
from isa_ros.surroundings.dump import LagDump, NoneDump, ValveDump
from isa_ros.surroundings.return_line import ReturnLine
from isa_ros.surroundings.supply import SupplySheet
from isa_ros.text.marked import with_parts
from isa_ros.text.table import markdown

PAGE = Path(__file__).resolve().parents[1] / 'docs' / 'run_file.md'
HEADER = ['key', 'value', 'default', 'meaning']
_OF_THE_URDF = dict.fromkeys(('low_deg', 'high_deg'), 'of the URDF')
_IN_TEXT = {InText.NEVER: 'no', InText.IF_ANY: 'yes', InText.ALWAYS: 'yes', InText.ONLY: 'only'}


def keys(table: KeyTable) -> list[str]:
    """Return the lines of the table of a section's keys."""
    return markdown([[*HEADER, 'resolved text'], *(
        [f'`{key.name}`', f'{key.kind.words}, {key.kind.unit}' if key.kind.unit
         else key.kind.words, _default(key.default, key.default_words), key.meaning,
         _IN_TEXT[key.in_text]] for key in table.keys)])


def parameters(*sets: type[Parameters]) -> list[str]:
    """Return the lines of the table of the keys of parameter sets, each once."""
    rows = {row[0]: row for cls in sets for row in rows_of(cls)}
    return markdown([HEADER, *rows.values()])


def rows_of(cls: type[Parameters]) -> Iterator[list[str]]:
    """Yield the cells of each key of a parameter set: key, value, default, meaning."""
    rows = parameter_rows(cls)
    for f in fields(cls):
        row = rows[f.name]
        if 'doc' in f.metadata:
            value = 'name' if 'is_name' in f.metadata else ' or '.join(
                f.metadata['names']) if 'names' in f.metadata else (
                f'number{"s" if "length" in f.metadata else ""}, {f.metadata["unit"]}')
            yield [f'`{f.name}`', value, _default(row.default, row.default_words), row.meaning]


def by_kind(union: object, defaults: Mapping[str, str] = MappingProxyType({})) -> list[str]:
    """Return the lines of the table of the keys of each kind; ``defaults`` are known here only."""
    return markdown([['kind', *HEADER], *(
        [f'`{kind}`', key, value, defaults.get(key.strip('`'), default), meaning]
        for kind, cls in members(union).items()
        for key, value, default, meaning in rows_of(cls))])


def _default(default: object, words: str) -> str:
    return 'required' if default is REQUIRED else words or '-'


def page(text: str) -> str:
    """Return the text of the page with the tables of today."""
    return with_parts(text, {
        'run': keys(RUN), 'supplies': keys(SUPPLY_KEYS), 'supply': by_kind(SupplySheet),
        'part': by_kind(Part), 'oil': parameters(CircuitOil),
        'heat': by_kind(TankHeat), 'warm oil': parameters(MineralOil), 'wall': by_kind(Wall),
        'return line': by_kind(ReturnLine), 'dump': by_kind(NoneDump | LagDump | ValveDump),
        'emergency stop': keys(GROUP), 'record': keys(RECORD), 'publish': keys(PUBLISH_KEYS),
        'storage': parameters(Storage), 'link': parameters(LinkSheet),
        'actuator': keys(ACTUATOR), 'leg': keys(LegConfig.KEYS), 'start': parameters(LegStart),
        'imu': parameters(Imu), 'external': keys(ExternalConfig.KEYS),
        'robot': keys(RobotConfig.KEYS), 'drive': keys(DRIVE),
        'linkage': by_kind(Linkage, _OF_THE_URDF), 'contact': keys(CONTACT),
        'joints': keys(START), 'root': parameters(RobotStartValues)})


if __name__ == '__main__':
    PAGE.write_text(page(PAGE.read_text(encoding='utf-8')), encoding='utf-8')
