"""
Write the tables of docs/signals.md from the fields of all samples.

    python scripts/write_signals.py
"""

from collections.abc import Sequence
from pathlib import Path

from isa_ros.config.paths import CONFIG, find
from isa_ros.config.runs.run_file import load_run
from isa_ros.core.fields import Field
from isa_ros.core.signals import SAMPLE_FIELDS
from isa_ros.surroundings.bodies.leg.leg import sample_fields
from isa_ros.surroundings.kept_ports import port_fields
from isa_ros.surroundings.mechanism_body import motion_fields
from isa_ros.surroundings.supply_sample import SUPPLY_FIELDS
from isa_ros.text.marked import with_parts
from isa_ros.text.table import markdown

PAGE = Path(__file__).resolve().parents[1] / 'docs' / 'signals.md'


def lines(fields: Sequence[Field]) -> list[str]:
    """Return the lines of a table with one row a field."""
    return markdown([['field', 'unit', 'meaning'], *(
        [f'`{field.name}`' + ''.join(f', {n} values' for n in field.shape),
         field.unit.replace(' | ', ' or '), field.meaning] for field in fields)])


def external_lines() -> list[str]:
    """Return the table of an external body: of a mechanism's actuators, and the ports of all."""
    motion = [Field(linear.name, f'{linear.unit} | {rotary.unit}', linear.meaning)
              for linear, rotary in zip(motion_fields('NAME', False), motion_fields('NAME', True))]
    return [line.replace(', 1 values', ', k values')
            for line in lines([*motion, *port_fields(1)])]


def _of_robot() -> list[Field]:
    """Return the fields of a robot, those of its parts once and by the kind of part."""
    robot, = load_run(find('quadruped', CONFIG)).bodies
    joint, foot, unit = 'lf_hfe', 'lf_foot', 'trunk'
    parts = (*robot.sheet.joints, *robot.sheet.contacts)
    others = [f'{own.name}_' for own in parts if own.name not in (joint, foot)]
    found = []
    for field in robot.fields:
        if field.name.startswith(tuple(others)):
            continue
        name = field.name
        for part, kind in ((joint, 'JOINT'), (foot, 'FOOT'), (f'{unit}_', 'UNIT_')):
            if name.startswith(part):
                name = kind + name.removeprefix(part)
        found.append(field._replace(name=name))
    return found


def page(text: str) -> str:
    """Return the text of the page with the tables of today."""
    return with_parts(text, {
        'actuator': lines(SAMPLE_FIELDS), 'supply': lines(SUPPLY_FIELDS),
        'leg': lines(sample_fields(['UNIT'])), 'robot': lines(_of_robot()),
        'external': external_lines()})


if __name__ == '__main__':
    PAGE.write_text(page(PAGE.read_text(encoding='utf-8')), encoding='utf-8')
