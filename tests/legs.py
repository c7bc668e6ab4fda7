"""The shipped legs, for the tests."""

from isa_ros.config.models.catalogue import leg_section
from isa_ros.config.text.parameter_sets import build
from isa_ros.surroundings.bodies.leg.sheet import LegSheet


def leg_sheet(name: str = 'hyq_real') -> LegSheet:
    """Return a shipped sheet."""
    return build(LegSheet, *leg_section(name, 'test'))
