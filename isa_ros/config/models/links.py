"""
Links of a run file: ``link`` for all actuators, and in an actuator's section for itself.

::

    link: {kind: ethercat, cycle_ms: 1, delay_cycles: 1, watchdog_ms: 10}
    actuators:
      kfe: {link: {loss: 0.01}}     # the rest is as above
"""

from typing import Any

from isa_ros.actuator.link import KINDS, NO_LINK, NONE
from isa_ros.config.text.parameter_sets import as_tree
from isa_ros.config.text.sections import merge, Place, Section, SourcedValue
from isa_ros.errors import ConfigError

LINK = 'link'


def link_of(run: Section, own: Section, step_ns: int, place: Place) -> Section:
    """
    Return the whole section of an actuator's link: its own keys, else those of the run.

    What neither has is 0, and the cycle then the tick. Without a kind there is no link.

    Raises
    ------
    ConfigError
        Keys are given, but no kind.

    """
    given: Section = {**run, **own}
    default = as_tree(NO_LINK)
    if given and 'kind' not in given and given.keys() <= default.keys():    # others are unknown
        raise ConfigError((place / LINK).has(f'lacks kind, one of {", ".join(KINDS)}'))
    section = merge(
        {key: SourcedValue(getattr(NO_LINK, key), str(place / LINK / key), 'default')
         for key in default}, given)
    if _value(section['kind']) != NONE and _value(section['cycle_ms']) in (0, 0.0):
        section['cycle_ms'] = SourcedValue(
            step_ns / 1e6, str(place / LINK / 'cycle_ms'), 'default')
    return section


def _value(entry: Any) -> Any:
    return entry.value if isinstance(entry, SourcedValue) else entry
