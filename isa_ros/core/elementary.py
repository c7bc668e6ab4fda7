"""
Elementary functions with the same bits on every processor and with every C library.

Those of a C library differ in their last bit from one version or processor to the next, and
replay compares bytes. These use + - * / sqrt, floor, frexp and the bits of powers of two only,
whose results are exact or rounded as IEEE 754 prescribes. The polynomials are Taylor's, so long
that the rest is far below the rounding. No branch divides the middle of a range, so that many
arguments could be computed at once.

From Python they are plain functions; kernels inline them. The tests measure the errors, stated
here in units in the last place (ulp), with 60 digits.
"""

import math

from isa_ros.core.kernel import kernel_function
import numpy as np

_PER_LN_2 = 1.4426950408889634
_LN_2_HIGH, _LN_2_LOW = 0.693147180559663, 2.8235290563031577e-13   # 41 bits of ln 2, the rest
_SMALLEST, _LARGEST = -708.0, 709.0     # of exp: its result and 2^k are normal numbers
_ROOT_HALF = 0.7071067811865476

_PER_HALF_PI = 0.6366197723675814
_HALF_PI_1 = 1.5707963267341256         # 33 bits of pi/2, the next 33 bits, and the rest
_HALF_PI_2 = 6.077100506303966e-11
_HALF_PI_3 = 2.0222662487959506e-21
_FAR = 1e6                              # the products with these parts are exact below


@kernel_function
def _power_of_two(k: int) -> float:
    """Return 2^k for -1022 <= k <= 1023, by its bits."""
    return float(np.int64((k + 1023) << 52).view(np.float64))


@kernel_function
def _small_exp(r: float) -> float:
    """Return e^r - 1 - r for |r| <= ln(2)/2: terms up to r^13, in pairs side by side."""
    s = r * r
    q = s * s
    low = (0.5 + r * (1 / 6)) + s * (1 / 24 + r * (1 / 120))
    middle = (1 / 720 + r * (1 / 5040)) + s * (1 / 40320 + r * (1 / 362880))
    high = (1 / 3628800 + r * (1 / 39916800)) + s * (1 / 479001600 + r * (1 / 6227020800))
    return s * (low + q * (middle + q * high))


@kernel_function
def _scaled_exp(x: float) -> tuple[float, float]:
    """Return (2^k, rest) with e^x = 2^k (1 + rest) and |rest| below 0.42."""
    k = math.floor(x * _PER_LN_2 + 0.5)
    high = x - k * _LN_2_HIGH       # exact
    low = k * _LN_2_LOW
    r = high - low
    return _power_of_two(k), r + (((high - r) - low) + _small_exp(r))


@kernel_function
def exp(x: float) -> float:
    """Return e^x, within 1 ulp; 0 for x < -708 and inf for x > 709."""
    if not _SMALLEST <= x <= _LARGEST:
        return x if x != x else 0.0 if x < 0.0 else math.inf
    power, rest = _scaled_exp(x)
    return power * (1.0 + rest)


@kernel_function
def log(x: float) -> float:
    """
    Return ln(x) of a normal number x > 0, within 1 ulp; -inf for 0, nan below.

    With x = 2^k m and s = (m - 1)/(m + 1): ln(m) = 2 (s + s^3/3 + s^5/5 + ...).
    """
    if not 0.0 < x < math.inf:
        return x if x > 0.0 or x != x else -math.inf if x == 0.0 else math.nan
    m, k = math.frexp(x)
    if m < _ROOT_HALF:
        m, k = 2.0 * m, k - 1
    f = m - 1.0
    s = f / (2.0 + f)
    z = s * s
    w = z * z
    even = 2 / 3 + w * (2 / 7 + w * (2 / 11 + w * (2 / 15 + w * (2 / 19 + w * (2 / 23)))))
    odd = 2 / 5 + w * (2 / 9 + w * (2 / 13 + w * (2 / 17 + w * (2 / 21))))
    rest = z * (even + z * odd)     # ln(m) = 2 s + s rest, and 2 s = f - s f
    half = 0.5 * f * f
    return k * _LN_2_HIGH + (f - (half - (s * (half + rest) + k * _LN_2_LOW)))


@kernel_function
def _reduced(x: float) -> tuple[int, float, float]:
    """Return (k, r, low) with x = k pi/2 + r + low and |r| about pi/4 at most."""
    if abs(x) > _FAR:
        x = x % (2.0 * math.pi)
    k = math.floor(x * _PER_HALF_PI + 0.5)
    first = x - k * _HALF_PI_1      # exact, as is the next product
    w = k * _HALF_PI_2
    r = first - w
    low = ((first - r) - w) - k * _HALF_PI_3
    whole = r + low
    return k, whole, (r - whole) + low


@kernel_function
def _small_sin(r: float, low: float) -> float:
    """Return sin(r + low) for |r| <= pi/4: terms up to r^17."""
    z = r * r
    w = z * z
    a = (-1 / 6 + z * (1 / 120)) + w * (-1 / 5040 + z * (1 / 362880))
    b = (-1 / 39916800 + z * (1 / 6227020800)) + w * (
        -1 / 1307674368000 + z * (1 / 355687428096000))
    return r + (z * r * (a + w * w * b) + low * (1.0 - 0.5 * z))


@kernel_function
def _small_cos(r: float, low: float) -> float:
    """Return cos(r + low) for |r| <= pi/4: terms up to r^18."""
    z = r * r
    w = z * z
    a = (1 / 24 + z * (-1 / 720)) + w * (1 / 40320 + z * (-1 / 3628800))
    b = (1 / 479001600 + z * (-1 / 87178291200)) + w * (
        1 / 20922789888000 + z * (-1 / 6402373705728000))
    half = 0.5 * z
    one = 1.0 - half
    return one + (((1.0 - one) - half) + (w * (a + w * w * b) - r * low))


@kernel_function
def sin(x: float) -> float:
    """
    Return the sine of x, within 1 ulp for |x| <= 1e6.

    A larger argument is first taken modulo 2 pi, which is rounded: an error of |x| 4e-17 rad.
    """
    if not abs(x) < math.inf:
        return math.nan
    k, r, low = _reduced(x)
    value = _small_sin(r, low) if k % 2 == 0 else _small_cos(r, low)
    return value if k % 4 < 2 else -value


@kernel_function
def cos(x: float) -> float:
    """Return the cosine of x, as `sin`."""
    if not abs(x) < math.inf:
        return math.nan
    k, r, low = _reduced(x)
    value = _small_cos(r, low) if k % 2 == 0 else _small_sin(r, low)
    return value if (k + 1) % 4 < 2 else -value


@kernel_function
def expm1(x: float) -> float:
    """Return e^x - 1, within 2 ulp; -1 for x < -40, inf for x > 709."""
    if not -40.0 <= x <= _LARGEST:
        return x if x != x else -1.0 if x < 0.0 else math.inf
    power, rest = _scaled_exp(x)
    return (power - 1.0) + power * rest


@kernel_function
def tanh(x: float) -> float:
    """Return the hyperbolic tangent e/(e + 2) with e = e^2|x| - 1, within 3 ulp."""
    size = abs(x)
    if size > 20.0:
        return math.copysign(1.0, x)
    e = expm1(2.0 * size)
    return math.copysign(e / (e + 2.0), x)


@kernel_function
def atan2(y: float, x: float) -> float:
    """
    Return the angle of (x, y) in [-pi, pi], within 3 ulp; 0 for (0, 0).

    A guess, turned by its own sine and cosine to what is left of the angle, t = tan(rest):
    rest = t - t^3/3 + t^5/5 - t^7/7.
    """
    a, b = abs(x), abs(y)
    if a == 0.0 and b == 0.0:
        return 0.0
    ratio = min(a, b) / max(a, b)
    guess = ratio * (0.7853981633974483 + 0.273 * (1.0 - ratio))    # within 4e-3 rad
    if b > a:
        guess = 1.5707963267948966 - guess
    s, c = sin(guess), cos(guess)
    t = (b * c - a * s) / (a * c + b * s)
    z = t * t
    angle = guess + t * (1.0 + z * (-1 / 3 + z * (1 / 5 + z * (-1 / 7))))
    if x < 0.0:
        angle = math.pi - angle
    return math.copysign(angle, y)


@kernel_function
def acos(x: float) -> float:
    """Return the angle in [0, pi] whose cosine is x, within 4 ulp; nan for |x| > 1."""
    return atan2(math.sqrt((1.0 - x) * (1.0 + x)), x) if abs(x) <= 1.0 else math.nan
