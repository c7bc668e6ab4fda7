"""
Run files: strict YAML in data-sheet units to a `RunConfig`.

Every error is one line with file, key, value, unit and bound.
"""

from pathlib import Path

from isa_ros.config.runs.robots import run_with_robots
from isa_ros.config.runs.run_config import RunConfig
from isa_ros.config.text.changes import changed, Values
from isa_ros.config.text.sections import Place
from isa_ros.config.text.yaml_text import read


def load_run(path: Path | str, changes: Values | None = None) -> RunConfig:
    """
    Return the resolved configuration of a run file, with some values changed.

    Raises
    ------
    ConfigError
        The file cannot be read, or its content cannot be run.

    """
    path = Path(path)
    return run_with_robots(changed(read(path), changes or {}, path.name), Place.of(path))[0]
