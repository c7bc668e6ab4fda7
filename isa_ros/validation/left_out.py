"""Values that the paper prints and no entry compares, each with the reason."""

from typing import NamedTuple

from isa_ros.paper.printed import cell, Printed, statement


class LeftOut(NamedTuple):
    """A printed value without an entry."""

    printed: Printed
    why: str


def left_out() -> tuple[LeftOut, ...]:
    """Return the values that are not modelled, or cannot be compared."""
    return (
        LeftOut(cell('table_3', 'Encoder Baud rate', 'ISA'),
                'not modelled: the time a position takes on the line, some tens of microseconds; '
                'the encoder is read without delay'),
        LeftOut(cell('table_3', 'Max current', 'ISA'),
                'not modelled: the supply current of the board (erratum 24)'),
        LeftOut(cell('table_2', 'Operating temperature (lowest)', 'ISA v5'),
                'not compared: it is the range of the parameters'),
        LeftOut(cell('table_2', 'Dry weight', 'ISA v5'),
                'not modelled: actuators have no mass of their own, the links of a leg have it'),
        LeftOut(cell('table_4', 'Position K_p', 'ISA V5'),
                'a gain that changes with the task (asterisk, erratum 12): section 5.2 prints the '
                'one of the drop, which is compared'),
        LeftOut(cell('table_4', 'Position K_d', 'ISA V5'), 'likewise'),
        LeftOut(cell('table_4', 'Spool K_p', 'ISA V5'),
                'in the variant `explicit` only (erratum 10), by the bandwidth it gives'),
        LeftOut(statement('impact_time'),
                'the origin of the time axis of Fig 20 is not printed; the fall is compared by '
                'its height'),
    )
