"""What machine code calls of C is the same as that of C, bit for bit."""

import ctypes
import math

from isa_ros.core.object_runtime import RUNTIME
from isa_ros.core.objects import assembled, library_of, own_target
import numpy as np
import pytest

# Zeros, subnormals, the least and the largest normal, whole numbers at the limits, halves.
VALUES = [sign * value for sign in (1.0, -1.0) for value in (
    0.0, 5e-324, 3e-320, 2.2250738585072e-308, 2.2250738585072014e-308, 1e-7, 0.49999999999999994,
    0.5, 1.0, 1.5, math.pi, 7.0, 1e9 + 0.5, 2.0 ** 52 - 0.5, 2.0 ** 52, 2.0 ** 53 + 2.0, 1e22,
    1.7976931348623157e308, math.inf)]


@pytest.fixture(scope='module')
def runtime(tmp_path_factory):
    """Return a library in which the functions are seen."""
    out = tmp_path_factory.mktemp('runtime') / 'runtime.so'
    library_of([assembled(RUNTIME.replace(' hidden ', ' '), own_target())], out)
    own = ctypes.CDLL(str(out))
    number = ctypes.c_double
    own.floor.restype = own.ceil.restype = own.fmod.restype = own.numba_frexp.restype = number
    own.rint.restype = number
    own.floor.argtypes = own.ceil.argtypes = own.rint.argtypes = [number]
    own.fmod.argtypes = [number, number]
    own.numba_frexp.argtypes = [number, ctypes.POINTER(ctypes.c_int32)]
    return own


def bits(value):
    """Return a number's bits; those of NaN differ from machine to machine."""
    return 'nan' if value != value else np.float64(value).tobytes().hex()


def random_values(n):
    """Return numbers of any size."""
    found = np.random.default_rng(71).integers(0, 2 ** 64, n, np.uint64).view(np.float64)
    return found[np.isfinite(found)].tolist()


@pytest.mark.parametrize('name', ['floor', 'ceil', 'rint'])
def test_whole_numbers(runtime, name):
    own, expected = getattr(runtime, name), getattr(np, name)
    near = np.random.default_rng(5).uniform(-9.0, 9.0, 500).tolist()
    near += [k / 2 for k in range(-9, 10)]
    for value in VALUES + near + random_values(500):
        assert bits(own(value)) == bits(float(expected(value))), value
    assert math.isnan(own(math.nan))


def test_frexp(runtime):
    exponent = ctypes.c_int32()
    for value in VALUES + random_values(2000):
        mantissa = runtime.numba_frexp(value, exponent)
        expected = math.frexp(value)
        assert (bits(mantissa), exponent.value) == (bits(expected[0]), expected[1]), value
    exponent.value = 9
    assert math.isnan(runtime.numba_frexp(math.nan, exponent)) and exponent.value == 0


def test_fmod(runtime):
    values = VALUES + random_values(300)
    for x in values:
        for y in VALUES + random_values(30):
            with np.errstate(invalid='ignore'):
                assert bits(runtime.fmod(x, y)) == bits(float(np.fmod(x, y))), (x, y)
    assert math.isnan(runtime.fmod(math.nan, 2.0)) and math.isnan(runtime.fmod(2.0, math.nan))


@pytest.mark.parametrize('n', [0, 1, 7, 64])
def test_memset(runtime, n):
    target = np.full(70, 3, np.uint8)
    runtime.memset(ctypes.c_void_p(target.ctypes.data + 2), 0x1a5, ctypes.c_int64(n))
    assert target.tolist() == [3, 3] + [0xa5] * n + [3] * (68 - n)


@pytest.mark.parametrize('name', ['memcpy', 'memmove'])
def test_copies(runtime, name):
    source, target = np.arange(1, 41, dtype=np.uint8), np.zeros(44, np.uint8)
    copy = getattr(runtime, name)
    copy(ctypes.c_void_p(target.ctypes.data + 3), ctypes.c_void_p(source.ctypes.data),
         ctypes.c_int64(40))
    assert target.tolist() == [0, 0, 0, *range(1, 41), 0]


@pytest.mark.parametrize('by', [-3, 3])
def test_a_move_within_itself(runtime, by):
    own = np.arange(20, dtype=np.uint8)
    expected = own.copy()
    expected[5 + by:15 + by] = own[5:15]
    start = own.ctypes.data + 5
    runtime.memmove(ctypes.c_void_p(start + by), ctypes.c_void_p(start), ctypes.c_int64(10))
    assert own.tolist() == expected.tolist()


def strides_of(runtime, array, shape, is_of_fortran=0):
    """Return the strides that an array of another shape gets, None: it has gaps."""
    def words(*numbers):
        return (ctypes.c_int64 * len(numbers))(*numbers)
    found = words(*[-7] * len(shape))
    number = ctypes.c_int64
    done = runtime.numba_attempt_nocopy_reshape(
        number(array.ndim), words(*array.shape), words(*array.strides), number(len(shape)),
        words(*shape), found, number(array.itemsize), ctypes.c_int32(is_of_fortran))
    return tuple(found) if done else None


@pytest.mark.parametrize('shape', [(24,), (2, 12), (3, 2, 4), (1, 24, 1)])
@pytest.mark.parametrize('array', [
    np.zeros(24), np.zeros((4, 6)), np.zeros((2, 3, 4)), np.zeros((4, 1, 6))[:, ::-1]])
def test_another_shape_of_an_array_without_gaps(runtime, array, shape):
    assert strides_of(runtime, array, shape) == np.zeros(shape).strides


@pytest.mark.parametrize('array', [
    np.zeros(48)[::2], np.zeros((4, 7))[:, :6], np.zeros((6, 4)).T, np.zeros(24)[::-1]])
def test_an_array_with_gaps_keeps_its_shape(runtime, array):
    assert strides_of(runtime, array, (2, 12)) is None


def test_the_order_of_fortran_is_refused(runtime):
    assert strides_of(runtime, np.zeros(24), (2, 12), is_of_fortran=1) is None
