"""The shipped legs as the tests need them."""

from isa_ros.catalogue import leg_section
from isa_ros.load.leg_sheet import LegSheet
from isa_ros.resolve import build


def leg_sheet(name: str = 'hyq_real') -> LegSheet:
    """Return a shipped sheet."""
    return build(LegSheet, *leg_section(name, 'test'))
