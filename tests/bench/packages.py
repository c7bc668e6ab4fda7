"""Packages that a measurement finds before this one."""

from pathlib import Path


def package_in(root: Path) -> Path:
    """Make an empty package isa_ros; without ``__init__.py`` an installed one would come first."""
    package = root / 'isa_ros'
    package.mkdir()
    (package / '__init__.py').touch()
    return package
