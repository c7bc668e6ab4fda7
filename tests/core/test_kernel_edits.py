"""Kernels after an edit of what they use: what is compiled again, and what they return."""

import sys
from types import ModuleType

from isa_ros.core import kernel as kernels
import pytest
from tests.core.test_kernel_key import FIRST, SOURCE

NAME = 'edited_kernels'
ALL = 'callee caller plain'


def called(directory, **changes):
    """Return what the kernel `caller` of an edited module returns, and what was compiled."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(kernels, 'CACHE', directory)
        module = ModuleType(NAME)
        patch.setitem(sys.modules, NAME, module)
        exec(SOURCE.format(**FIRST | changes), vars(module))
        result = module.caller(0.3)
    made = {'callee': module.callee, 'caller': module.caller, 'plain': module.plain.kernel}
    return result, ' '.join(name for name, one in made.items() if one.stats.cache_misses)


@pytest.fixture(scope='module')
def kept(tmp_path_factory):
    """Return a directory with the kernels before any edit, and what `caller` returns."""
    directory = tmp_path_factory.mktemp('kernels')
    result, compiled = called(directory)
    assert compiled == ALL
    return directory, result


@pytest.mark.parametrize('changes', [
    {}, {'remark': '# A remark.'}, {'doc': ''}, {'unused': 5}])
def test_what_no_kernel_reads_may_change(kept, changes):
    directory, before = kept
    assert called(directory, **changes) == (before, '')


@pytest.mark.parametrize(('changes', 'compiled'), [
    ({'constant': 2.0}, 'callee caller'), ({'added': 2}, ALL), ({'kind': 'f4'}, 'caller'),
    ({'entry': 3.0}, 'caller'), ({'default': 2.0}, 'caller')])
def test_results_after_an_edit_are_those_of_an_empty_cache(kept, tmp_path, changes, compiled):
    directory, before = kept
    after, of_edited = called(directory, **changes)
    assert (after, ALL) == called(tmp_path, **changes)
    assert after != before
    assert of_edited == compiled
    assert called(directory) == (before, '')      # the edit is taken back
    assert called(directory, **changes) == (after, '')
