"""
Write the tables of docs/scenario_file.md from the keys of a scenario and its waveforms.

    python -m scripts.write_scenario_file
"""

from collections.abc import Mapping
from pathlib import Path

from isa_ros.config.models.catalogue import gait_section
from isa_ros.config.text.sections import SourcedValue
from isa_ros.scenario.keys import FAULT, KeyRow, ROBOTS, SCENARIO, SETPOINT
from isa_ros.scenario.trot_motion import GAIT, GaitParameters
from isa_ros.scenario.waveforms import OF_SETPOINTS
from isa_ros.text.marked import with_parts
from isa_ros.text.table import markdown
from scripts.write_run_file import HEADER, rows_of

PAGE = Path(__file__).resolve().parents[1] / 'docs' / 'scenario_file.md'
_OF_ALL = {'moves': 'position', 'amplitude': 'required'}


def keys(table: Mapping[str, KeyRow]) -> list[str]:
    """Return the lines of the table of a section's keys."""
    return markdown([HEADER, *([f'`{key}`', *row] for key, row in table.items())])


def waveforms() -> list[str]:
    """Return the lines of the table of the keys of each waveform, after those of all."""
    rows = {kind: list(rows_of(cls)) for kind, cls in OF_SETPOINTS.items()}
    own = [[f'`{kind}`', *row] for kind, table in rows.items() for row in table
           if row[0].strip('`') not in _OF_ALL]
    first = next(iter(rows.values()))
    common = [['all', *row[:2], _OF_ALL[name], row[3]] for row in first
              if (name := row[0].strip('`')) in _OF_ALL]
    return markdown([['waveform', *HEADER], *common, *own])


def gait() -> list[str]:
    """Return the lines of the table of the keys of a gait, with the values of the trot."""
    of_trot = {f'`{key}`': str(own.value) for key, own in gait_section(GAIT, GAIT).items()
               if isinstance(own, SourcedValue)}
    return markdown([HEADER, *(
        [key, value, of_trot.get(key, default), meaning]
        for key, value, default, meaning in rows_of(GaitParameters))])


def page(text: str) -> str:
    """Return the text of the page with the tables of today."""
    return with_parts(text, {
        'scenario': keys({**SCENARIO, 'robots': ROBOTS}), 'setpoint': keys(SETPOINT),
        'waveform': waveforms(), 'gait': gait(), 'fault': keys(FAULT)})


if __name__ == '__main__':
    PAGE.write_text(page(PAGE.read_text(encoding='utf-8')), encoding='utf-8')
