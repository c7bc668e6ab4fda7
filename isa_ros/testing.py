"""
Regression tests from bags, for this package and its users.

In a conftest.py: ``pytest_plugins = ['isa_ros.testing']``; in a test::

    def test_my_leg_drops_as_recorded(assert_replays):
        assert_replays('bags/drop', 'bags/tolerances.yaml')

Without a tolerance file every bit must be equal. This holds on the same kind of machine with the
same versions. `assert_replays` may also be imported and called.
"""

from collections.abc import Callable
from pathlib import Path
import platform

from isa_ros.bag.reader import Bag
from isa_ros.replay.replay import replay
from isa_ros.replay.tolerances import load_tolerances
import pytest

__all__ = ['assert_replays', 'AssertReplays']

AssertReplays = Callable[..., None]

_CPU_INFO = Path('/proc/cpuinfo')


def assert_replays(bag: Path | str, tolerances: Path | str | None = None) -> None:
    """
    Simulate a bag again and compare every message.

    Raises
    ------
    AssertionError
        The replay differs; the message has the first tick, topic and field with both values, and
        the differences between this installation and the one that recorded the bag.
    BagError, ConfigError
        The bag or the tolerance file cannot be read, or the bag cannot be simulated.

    """
    recorded = Bag(Path(bag))
    allowed = None if tolerances is None else load_tolerances(Path(tolerances), recorded.types)
    report = replay(recorded, allowed)
    if not report.is_equal:
        lines = [f'{bag}: {report}', *report.changes]
        if tolerances is None:
            lines += _why_bits_differ(bool(report.changes))
        raise AssertionError('\n'.join(lines))


@pytest.fixture(name='assert_replays')
def _assert_replays() -> AssertReplays:
    """Return `assert_replays`."""
    return assert_replays


def _why_bits_differ(has_changes: bool) -> list[str]:
    """Return possible reasons of unequal bits; a bag has no data of its machine."""
    versions = (
        'Versions or topics differ as listed' if has_changes else
        'Versions and topics are those of the bag')
    return [
        'No tolerances were given, so every bit must be equal, which holds with the same '
        f'versions on the same kind of CPU. {versions}; the CPU here is {_cpu()}, that of the '
        'recording is not stored in the bag. For other versions or CPUs give tolerances.']


def _cpu() -> str:
    """Return the name of this machine's processor."""
    try:
        for line in _CPU_INFO.read_text(encoding='utf-8', errors='replace').splitlines():
            key, _, value = line.partition(':')
            if key.strip() == 'model name':
                return value.strip()
    except OSError:
        pass
    return platform.machine()
