"""Threads for matrices, as nobody has asked for any number of them."""

from isa_ros.core.openblas import NAMES
import pytest


def forget_number(monkeypatch: pytest.MonkeyPatch) -> None:
    """Take what the user, or the suite, has set from the environment, until the test's end."""
    for name in NAMES:
        monkeypatch.setenv(name, '')    # it may not be there
        monkeypatch.delenv(name)
