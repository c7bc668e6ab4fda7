"""What the numbers of a saved state may be, as runs of numbers of one kind."""

from isa_ros.actuator.link import LINK_STATE
from isa_ros.core.signals import COMMAND
from isa_ros.export.state_checks import Check, checks, FINITE, GAIN
import numpy as np

BELOW = np.dtype([('mode', 'i8'), ('level', 'f8')])
ROW = np.dtype([('x', 'f8', (3,)), ('steps', 'i8'), ('status', BELOW), ('levels', BELOW, (2,)),
                ('kinds', 'u4'), ('is_enabled', 'u4')])


def test_runs_of_a_record():
    """Names are those of the ranges; whole numbers without one are counts."""
    assert checks([('own', np.zeros(1, ROW))]) == [
        Check(8, 3, 8, FINITE, 'own.x'),
        Check(40, 1, 8, 6, 'own.status.mode'), Check(48, 1, 8, FINITE, 'own.status.level'),
        Check(64, 1, 8, FINITE, 'own.levels.level'), Check(80, 1, 8, FINITE, 'own.levels.level'),
        Check(88, 1, 4, 255, 'own.kinds'), Check(92, 1, 4, 1, 'own.is_enabled')]


def test_gains_of_commands_may_be_nan():
    found = {own.first: own for own in checks([('c', np.zeros(2, COMMAND))])}
    assert found['c.stiffness'].largest == GAIN and found['c.stiffness'].length == 2
    assert found['c.position'].largest == FINITE and found['c.position'].length == 3
    again = [own for own in checks([('c', np.zeros(2, COMMAND))]) if own.first == 'c.kinds']
    assert [own.at for own in again] == [8, 8 + COMMAND.itemsize]


def test_lines_of_a_link():
    found = checks([('links', np.zeros(1, LINK_STATE))])
    assert [own.first.removeprefix('links.') for own in found] == [
        f'{line}.{name}' for line in ('down', 'up') for name in ('first', 'count', 'is_bad')]
    assert len({own.largest for own in found}) == 3


def test_parts_follow_each_other():
    rows = np.zeros(2, [('x', 'f8')])
    assert checks([('a', rows), ('b', rows)]) == [Check(8, 4, 8, FINITE, 'a.x')]
