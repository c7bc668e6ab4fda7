"""What a compiled kernel depends on."""

from isa_ros.core.kernel_key import is_unchanged, kernel_digest, UnknownValue, value_text
import numpy as np
import pytest

SOURCE = """
{remark}
import math
import numpy as np
from isa_ros.core import timebase
from isa_ros.core.kernel import kernel, kernel_function
CONSTANT = {constant}
KIND = np.dtype([('a', {kind!r})])
TABLE = np.array([1.0, {entry}])
UNUSED = {unused}
@kernel_function
def plain(x):
    return x + {added}
@kernel
def callee(x):
    {doc}
    return plain(x) * CONSTANT
@kernel
def caller(x, b={default}):
    buffer = np.zeros(1, KIND)
    buffer[0].a = 0.1
    return callee(x) + timebase.PLANT_STEP_NS + buffer[0].a + TABLE[1] + math.sin(b)
@kernel
def other(x):
    return x
"""
FIRST = {'remark': '', 'constant': 1.0, 'kind': 'f8', 'entry': 2.0, 'unused': 1, 'added': 1,
         'doc': '"""One."""', 'default': 1.0}


def digests(**changes):
    """Return the digests of `callee`, `caller` and `other`."""
    space = {'__name__': 'somewhere'}
    exec(SOURCE.format(**FIRST | changes), space)
    return [kernel_digest(space[name]) for name in ('callee', 'caller', 'other')]


@pytest.mark.parametrize(('changes', 'changed'), [
    ({}, ''), ({'remark': '# a remark\n\n'}, ''), ({'doc': '"""Two."""'}, ''), ({'doc': ''}, ''),
    ({'unused': 2}, ''), ({'constant': 2.0}, 'callee caller'), ({'constant': 1}, 'callee caller'),
    ({'added': 2}, 'callee caller'), ({'kind': 'f4'}, 'caller'), ({'entry': 3.0}, 'caller'),
    ({'default': 2.0}, 'caller'), ({'constant': -0.0}, 'callee caller')])
def test_a_digest_changes_with_what_matters_only(changes, changed):
    names = ('callee', 'caller', 'other')
    pairs = zip(names, digests(), digests(**changes), strict=True)
    assert [name for name, before, after in pairs if before != after] == changed.split()


def test_an_imported_constant_is_seen_and_a_later_change_is_not_kept(monkeypatch):
    from isa_ros.core import timebase
    space = {'__name__': 'somewhere'}
    exec(SOURCE.format(**FIRST), space)
    digest = kernel_digest(space['caller'])
    assert is_unchanged(space['caller'])
    monkeypatch.setattr(timebase, 'PLANT_STEP_NS', 10_000)
    assert digests()[1] != digest
    assert kernel_digest(space['caller']) == digest
    assert not is_unchanged(space['caller'])


def test_calls_in_a_circle_have_digests():
    space = {'__name__': 'somewhere'}
    exec('from isa_ros.core.kernel import kernel\n'
         '@kernel\ndef even(n):\n    return True if n == 0 else odd(n - 1)\n'
         '@kernel\ndef odd(n):\n    return False if n == 0 else even(n - 1)\n', space)
    assert kernel_digest(space['even']) != kernel_digest(space['odd'])


def test_a_value_of_unknown_kind_is_refused():
    with pytest.raises(UnknownValue, match='builtins.object'):
        value_text(object())


def test_all_of_a_dtype_is_seen():
    kinds = [np.dtype([('a', 'f8'), ('b', 'f4')]),
             np.dtype([('a', 'f8'), ('b', 'f4')], align=True),
             np.dtype([('b', 'f8'), ('a', 'f4')]), np.dtype([('a', 'f8'), ('b', 'f4', 1)]),
             np.dtype([('a', 'f8'), ('b', 'f4', 2)]), np.dtype([('a', '>f8'), ('b', 'f4')])]
    assert len({value_text(kind) for kind in kinds}) >= 5
