"""What a compiled kernel depends on."""

import dis
from importlib.util import module_from_spec, spec_from_file_location
from typing import NamedTuple

from isa_ros.core import value_text as texts
from isa_ros.core.kernel_key import is_unchanged, kernel_digest, source_digest
from isa_ros.core.value_text import type_text, UnknownValue, value_text
import numba
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


def one(source: str) -> bytes:
    """Return the digest of the kernel `f` of a source."""
    space = {'__name__': 'somewhere'}
    exec('from enum import IntEnum\nfrom typing import NamedTuple\nimport numba\n'
         f'import numpy as np\nfrom isa_ros.core.kernel import kernel\n{source}', space)
    return kernel_digest(space['f'])


CALL = '@kernel\ndef f(x):\n    return C'
MADE = 'def made(c):\n    @kernel\n    def f(x):\n        return x + c\n    return f\nf = made({})'
CODE = '@kernel\ndef g(x):\n    return x + {}\n'
LOCAL = '@kernel\ndef f({}):\n    x = 1\n    return x'
OWN = '@kernel\ndef f({}):\n    return 1'
TRY = '@kernel\ndef f(x):\n{}    try:\n{}        b = 1\n    except Exception:\n        b = 2\n'
SUM = '@kernel\ndef f(x):\n    return (' + ', '.join(f'x + {k}.5' for k in range(300)) + ', {})'


@pytest.mark.parametrize(('first', 'second'), [
    (MADE.format(1), MADE.format(2)),
    (OWN.format('x, *, b=1'), OWN.format('x, *, b=2')),
    (OWN.format('x'), OWN.format('y')), (LOCAL.format(''), LOCAL.format('*x')),
    (OWN.format('x'), OWN.format('x').replace('f(', 'g(') + '\nf = g'),
    (f'C = 1\n{CALL.replace("C", "(lambda y: y + C)(x)")}',
     f'C = 2\n{CALL.replace("C", "(lambda y: y + C)(x)")}'),
    (CODE.format(1) + f'C = (g, (g, 2))\n{CALL}[0](x)',
     CODE.format(2) + f'C = (g, (g, 2))\n{CALL}[0](x)'),
    (CODE.format(1) + f'C = ((g,), 2)\n{CALL}[0][0](x)',
     CODE.format(2) + f'C = ((g,), 2)\n{CALL}[0][0](x)'),
    ('@numba.njit(error_model="numpy")\ndef f(x):\n    return x',
     '@numba.njit(error_model="python")\ndef f(x):\n    return x'),
    (f'class C(IntEnum):\n    A = 1\n{CALL}.A', f'class C(IntEnum):\n    A = 2\n{CALL}.A'),
    (f'class E(IntEnum):\n    A = 1\n    B = 2\nC = E.A\n{CALL}',
     f'class E(IntEnum):\n    A = 1\n    B = 2\nC = E.B\n{CALL}'),
    (f'class C(NamedTuple):\n    a: int\n{CALL}(x)',
     f'class C(NamedTuple):\n    b: int\n{CALL}(x)'),
    (f'C = np.zeros((2, 3))\n{CALL}', f'C = np.zeros((3, 2))\n{CALL}'),
    (f'C = np.zeros((2, 2))\n{CALL}', f'C = np.zeros((2, 2), order="F")\n{CALL}'),
    (f'C = frozenset((1, 2))\n{CALL}', f'C = frozenset((1, 3))\n{CALL}'),
    (TRY.format('    a = 1\n', ''), TRY.format('', '        a = 1\n')),
    (SUM.format(1), SUM.format(2))])
def test_all_that_a_kernel_is_changes_its_digest(first, second):
    assert one(first) == one(first) != one(second)


def test_instructions_are_those_of_dis():
    """Also with arguments of three bytes."""
    code = compile('x = 1\n' + '\n'.join(f'y{k} = {k}.5' for k in range(66_000)), 'large', 'exec')
    left_out = ('EXTENDED_ARG', 'CACHE', 'NOP')
    assert list(texts._instructions(code)) == [
        (each.opcode, each.arg or 0) for each in dis.get_instructions(code)
        if each.opname not in left_out]


class Pair(NamedTuple):
    a: int
    b: int


def other_pair() -> type:
    class Pair(NamedTuple):
        a: int
        c: int
    Pair.__qualname__ = 'Pair'
    return Pair


def test_types_of_arguments_are_told_apart():
    values = [1, 1.0, (1, 1.0), (1.0, 1), Pair(1, 2), other_pair()(1, 2), np.zeros(2),
              np.zeros(2, 'f4'), np.zeros((2, 2)), np.zeros(2, [('a', 'f8')]),
              np.zeros(2, [('b', 'f8')]), np.zeros(2, [('a', 'f8'), ('b', 'f8')]), True, 'text']
    texts = {type_text(numba.typeof(value)) for value in values}
    assert len(texts) == len(values)


def test_a_kernel_as_an_argument_is_refused():
    with pytest.raises(UnknownValue):
        type_text(numba.typeof(numba.njit(lambda x: x)))


def test_all_of_a_dtype_is_in_its_text():
    """A field at another place, and padding at the end."""
    kinds = [np.dtype({'names': ['a'], 'formats': ['f8'], 'offsets': [at], 'itemsize': size})
             for at, size in ((0, 8), (0, 16), (8, 16))]
    kinds += [np.dtype([('a', 'f8')], align=True)]
    assert len({value_text(kind) for kind in kinds}) == 4


def module_of(tmp_path, name, **changes):
    """Return a module of `SOURCE` in a file of that name."""
    path = tmp_path / f'{name}.py'
    path.write_text(SOURCE.format(**FIRST | changes))
    spec = spec_from_file_location('somewhere', path)
    module = module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize('changes', [
    {'remark': '# a remark'}, {'doc': '"""Two."""'}, {'constant': 2.0}, {'added': 2},
    {'unused': 2}])
def test_every_edit_of_its_file_changes_the_digest_by_source(tmp_path, changes):
    first, other = module_of(tmp_path, 'first'), module_of(tmp_path, 'other', **changes)
    same = module_of(tmp_path, 'same')
    assert source_digest(first.other) == source_digest(same.other) != source_digest(other.other)


def test_a_digest_by_source_has_the_values_that_a_kernel_names(tmp_path):
    first, second, third = (module_of(tmp_path, name) for name in ('first', 'second', 'third'))
    second.CONSTANT = 2.0
    third.callee = third.other
    assert len({source_digest(own.caller) for own in (first, second, third)}) == 3
    assert source_digest(first.other) == source_digest(second.other)
    assert source_digest(first.caller) != source_digest(first.callee)


def test_functions_of_other_packages_are_their_names(tmp_path):
    """Their texts differ from version to version."""
    first, second = (module_of(tmp_path, name) for name in ('first', 'second'))
    second.math = type(second.math)('math')
    second.math.sin = len
    assert source_digest(first.caller) == source_digest(second.caller)


def test_without_a_source_there_is_no_digest_by_it(tmp_path):
    module = module_of(tmp_path, 'gone')
    (tmp_path / 'gone.py').unlink()
    with pytest.raises(UnknownValue, match='^source .*gone.py$'):
        source_digest(module.caller)
    space = {'__name__': 'somewhere'}
    exec(SOURCE.format(**FIRST), space)
    with pytest.raises(UnknownValue, match='^source <string>$'):
        source_digest(space['caller'])
