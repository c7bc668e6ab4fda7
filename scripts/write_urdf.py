"""
Write urdf/*.urdf, the shipped legs without inertial units, from their run files.

    python scripts/write_urdf.py
"""

from collections.abc import Iterator
from pathlib import Path

from isa_ros.config.paths import CONFIG, find
from isa_ros.config.runs.run_file import load_run

URDF = Path(__file__).resolve().parents[1] / 'urdf'
LEGS = ('leg', 'hyq_leg')


def texts() -> Iterator[tuple[Path, str]]:
    """Yield the files with their content."""
    for name in LEGS:
        run = load_run(find(name, CONFIG))
        if run.leg is not None:
            yield URDF / f'{run.leg.model}_leg.urdf', run.description(run.leg, URDF)


if __name__ == '__main__':
    for path, text in texts():
        path.write_text(text, encoding='utf-8')
