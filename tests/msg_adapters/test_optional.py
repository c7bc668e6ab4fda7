"""Which optional message packages are there."""

from pathlib import Path

from msg_adapters.optional import is_installed, OPTIONAL
import pytest


def test_a_package_that_can_be_imported_is_installed():
    assert is_installed('msg_adapters')
    assert not is_installed('no_such_package_of_messages')


def test_a_folder_of_its_name_is_no_package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """As sources beside a program, which Python would import as a namespace."""
    (tmp_path / 'folder_of_messages' / 'msg').mkdir(parents=True)
    monkeypatch.syspath_prepend(str(tmp_path))
    assert not is_installed('folder_of_messages')


def test_the_packages_are_those_of_ros():
    assert list(OPTIONAL) == ['simulation_interfaces', 'tf2_msgs']
