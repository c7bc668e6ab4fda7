"""Which release replays a bag that this version does not, and how to get it."""

from collections.abc import Mapping
from pathlib import Path
import shlex

from isa_ros.bag.provenance import have_comparable_kernels, KERNELS
from isa_ros.core.version import RELEASES, VERSION
from isa_ros.run.provenance import recorded_versions

OWN = 'isa_ros'
"""Its name among the versions of a bag."""


def release_that_replays(path: Path, versions: Mapping[str, str]) -> str:
    """
    Return which release replays a bag with these versions, and the commands that do it.

    '' for a bag of this version, whose equations are those of here: nothing else would replay it.
    """
    there, here = versions.get(OWN, ''), recorded_versions()
    if there in RELEASES and there != VERSION:
        place = f'../isa_ros-{there}'
        return (f'recorded by isa_ros {there}, which replays it; in a clone: git worktree add '
                f'{place} {there} && {place}/isa replay {shlex.quote(str(path.resolve()))}')
    is_of_here = there == VERSION and not (
        have_comparable_kernels(versions, here) and versions[KERNELS] != here[KERNELS])
    if is_of_here:
        return ''
    named = f'isa_ros {there}' if there else 'a version that is not recorded'
    known = f'the releases are {", ".join(RELEASES)}' if RELEASES else 'there is no release yet'
    return (f'recorded by {named} with other equations than those of this version, between two '
            f'releases ({known}); the commit that recorded it replays it')
