"""The version of isa_ros: the one place that setup.py, bags and `isa --version` take it from."""

VERSION = '0.1.0'
"""That of the last release in CHANGELOG.rst; package.xml repeats it for ROS."""

RELEASES: tuple[str, ...] = ()
"""Those in CHANGELOG.rst, the last one first; each is a tag of the repository."""
