"""The SI records of every shipped sheet are the stored ones, also with any parameter moved."""

import json
from multiprocessing import get_context

from isa_ros.core import units
from isa_ros.plant import relief
import pytest
from tests.plant.records import digests, REFUSED, STORED

EXPECTED = json.loads(STORED.read_text(encoding='utf-8'))


@pytest.mark.slow
def test_every_record_is_the_stored_one() -> None:
    """`python -m tests.plant.records` after a wanted change of a record or of a value."""
    found = digests()
    assert [key for key in EXPECTED | found if found.get(key) != EXPECTED.get(key)] == []


def test_nearly_every_parameter_can_be_moved() -> None:
    """Those that cannot are rates, delays and limits that must fit another value."""
    refused = [key for key, digest in EXPECTED.items() if digest == REFUSED]
    assert len(refused) < 0.04 * len(EXPECTED)


def test_a_wrong_factor_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    """
    By 0.01 %, in the builder of one part; of the plain sheet, all but a few depend on it.

    In a process of its own: records are remembered, and other tests shall not find these.
    """
    monkeypatch.setattr(relief, 'LPM', 1.0001 * units.LPM)
    with get_context('fork').Pool(1) as pool:
        found = pool.apply(digests, ('isa_v2, default, plain',))
    assert len(found) > 150
    assert all(EXPECTED[key] != digest for key, digest in found.items() if digest != REFUSED)
