"""`isa draw`: the linkages of the bodies of a run file."""

from pathlib import Path

from isa_ros.analysis.figure_file import refuse_figure
from isa_ros.analysis.linkages.drives import DrawnDrive, drives_of_run
from isa_ros.analysis.linkages.figure import linkage_figure
from isa_ros.config.runs.run_file import load_run
from isa_ros.config.text.changes import Values
from isa_ros.errors import ConfigError
from isa_ros.text.table import aligned

HEADER = ('drive', 'linkage', 'range', 'position', 'stroke', 'start', 'lever')


def draw(config: Path, changes: Values, out: Path) -> str:
    """
    Write the figure of a run file, and return the table of its drives.

    Raises
    ------
    ConfigError
        The run file cannot be run or has no such body, or the format of ``out`` is unknown.

    """
    refuse_figure(out)
    run = load_run(config, changes)
    drives = drives_of_run(run)
    if not drives:
        raise ConfigError(
            f'{config.name}: has no linkage to draw: a body of the kind leg or robot has some')
    linkage_figure(drives, f'{run.name}: linkages and levers').savefig(out)
    return '\n'.join(aligned([HEADER, *(_row(name, own) for own in drives for name in own.names)]))


def _row(name: str, own: DrawnDrive) -> tuple[str, ...]:
    reach, scale = own.reach, own.scale
    is_length = reach.turns and not own.is_rotary
    levers = reach.levers * (1e3 if is_length else 1.0)
    low, high = reach.coordinates[0] / reach.scale, reach.coordinates[-1] / reach.scale
    return (
        name, own.kind, f'{low:.5g} to {high:.5g} {reach.unit}',
        f'{reach.positions.min() / scale:.5g} to {reach.positions.max() / scale:.5g} {own.unit}',
        f'{own.stroke / scale:.5g} {own.unit}', f'{own.position / scale:.5g} {own.unit}',
        f'{levers.min():.4g} to {levers.max():.4g}{" mm" if is_length else ""}')
