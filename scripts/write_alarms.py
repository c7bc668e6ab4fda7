"""
Write the table of docs/protection.md that says which shipped scenarios warn or trip, from runs.

Some minutes:

    python -m scripts.write_alarms

Every shipped configuration is run under each scenario that fits it, for `LONGEST_S` at most.
"""

from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import NamedTuple
import warnings

import isa_ros
from isa_ros.config.paths import CONFIG, SCENARIOS, shipped
from isa_ros.errors import ConfigError
from isa_ros.text.marked import with_parts
from isa_ros.text.table import markdown
import numpy as np

PAGE = Path(__file__).resolve().parents[1] / 'docs' / 'protection.md'
LONGEST_S = 10.0
HEADER = ('scenario', 'configuration', 'warnings', 'trips')


class Alarms(NamedTuple):
    """Names of the conditions that any actuator of a run warned of, and that tripped."""

    warnings: tuple[str, ...]
    trips: tuple[str, ...]


def alarms_of(run: isa_ros.Run) -> Alarms:
    """
    Return the alarms of a run, of its first `LONGEST_S`.

    Raises
    ------
    ConfigError
        A controller of its scenario refuses the configuration.

    """
    with warnings.catch_warnings():
        warnings.simplefilter('ignore')     # of trips, and of requests beyond a stroke
        result = run.simulate(min(run.scenario.duration_s or LONGEST_S, LONGEST_S))
    return Alarms(*(tuple(isa_ros.conditions(int(np.bitwise_or.reduce(np.concatenate([
        result[f'{name}.{field}'].astype(np.int64) for name in run.actuators])))))
        for field in Alarms._fields))


def fitting() -> Iterator[tuple[str, str, isa_ros.Run]]:
    """Yield scenario, configuration and run of all that fit, but for their controllers."""
    for scenario in shipped(SCENARIOS):
        for config in shipped(CONFIG):
            try:
                yield scenario, config, isa_ros.load(config, scenario)
            except ConfigError:
                continue    # it is for actuators of another configuration


def rows(pairs: Iterable[tuple[str, str, isa_ros.Run]]) -> list[tuple[str, ...]]:
    """Return a row of the table for each run with an alarm."""
    found = []
    for scenario, config, run in pairs:
        try:
            alarms = alarms_of(run)
        except ConfigError:
            continue    # its controller is for another robot
        if any(alarms):
            found.append((f'`{Path(scenario).stem}`', f'`{Path(config).stem}`', *(
                ', '.join(f'`{name}`' for name in names) for names in alarms)))
    return found


def main() -> None:
    """Write the page."""
    table = markdown([HEADER, *rows(fitting())])
    PAGE.write_text(with_parts(PAGE.read_text(encoding='utf-8'), {'alarms': table}),
                    encoding='utf-8')
    print(PAGE)


if __name__ == '__main__':
    main()
