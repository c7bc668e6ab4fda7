"""
From joint angle to actuator coordinate: lever arm and its derivative, analytic.

Conventions
- ``q`` is the joint angle (rad), ``x`` the actuator's own coordinate: piston position
  (m, 0 retracted) of a linear actuator, shaft angle (rad) of a rotary one.
- The lever is r = dx/dq (m/rad, or 1 for the rotary one), so that the joint torque is
  r F by virtual work, x' = r q' and x'' = r q'' + (dr/dq) q'^2  (L2).
- Every kernel returns (x, r, dr/dq).

Equations L2-L5 of docs/equations.md. Neglected: play and compliance of pins and links,
their mass (it is part of the links of the body).
"""

import math

from isa_ros.core.elementary import cos, sin
from isa_ros.core.kernel import kernel
import numpy as np
from numpy.typing import ArrayLike, NDArray

DIRECT = 0
SLIDER_CRANK = 1
FOUR_BAR = 2
KINDS = ('direct', 'slider_crank', 'four_bar')

LINKAGE = np.dtype([
    ('kind', '<i8'),
    ('sense', '<f8'),              # +1: x grows with q, -1: x grows with -q
    ('offset', '<f8'),             # rad, added to sense * q
    ('retracted_length', '<f8'),   # pin to pin at x = 0, m
    ('a', '<f8'), ('b', '<f8'),    # slider-crank: joint to the two pins, m
    ('ak_x', '<f8'), ('ak_y', '<f8'),  # four-bar: pin A in the thigh's frame, m
    ('bk', '<f8'),                 # four-bar: K to B on the shank, m
    ('ar', '<f8'), ('br', '<f8'),  # four-bar: links A-R and B-R, m
    ('c_x', '<f8'), ('c_y', '<f8'),  # four-bar: the cylinder's pin in the thigh's frame, m
])
"""One joint's linkage in SI; fields of another kind are zero."""


@kernel
def direct(q, linkage):
    """Return the shaft angle theta = sense q + offset, lever sense  (L3), rad and 1."""
    return linkage.sense * q + linkage.offset, linkage.sense, 0.0


@kernel
def slider_crank(q, linkage):
    """
    Return piston position, lever and its derivative of a slider-crank  (L4).

    L^2 = a^2 + b^2 - 2 a b cos(gamma), gamma = sense q + offset, x = L - L_0,
    r = sense a b sin(gamma) / L, dr/dq = (a b cos(gamma) - r^2) / L.
    L > 0 is guaranteed by a != b (checked with the data sheet).
    """
    gamma = linkage.sense * q + linkage.offset
    a_b = linkage.a * linkage.b
    a_b_cos = a_b * cos(gamma)
    length = math.sqrt(linkage.a * linkage.a + linkage.b * linkage.b - 2.0 * a_b_cos)
    lever = linkage.sense * a_b * sin(gamma) / length
    return length - linkage.retracted_length, lever, (a_b_cos - lever * lever) / length


@kernel
def four_bar(q, linkage):
    """
    Return piston position, lever and its derivative of the knee's four-bar  (L5).

    In the thigh's frame (origin at the knee K, first axis towards the hip, second axis
    towards the flexion side) with theta = sense q + offset the angle of B:
    B = bk (cos theta, sin theta), D = B - A, D^2 = |D|^2,
    R = A + u D - w n(D) with n(D) = (-D_y, D_x), u = (1 + (ar^2 - br^2) / D^2) / 2 and
    w = sqrt(ar^2 / D^2 - u^2): R lies on the extension side of A-B;
    L = |R - C|, x = L - L_0, r = (R - C) . R' / L, dr/dq = (R'.R' + (R - C).R'' - r^2) / L.
    Valid while A-R-B is a triangle (w > 0, checked with the data sheet).
    """
    theta = linkage.sense * q + linkage.offset
    b1_x = -linkage.sense * linkage.bk * sin(theta)
    b1_y = linkage.sense * linkage.bk * cos(theta)
    b2_x, b2_y = -linkage.bk * cos(theta), -linkage.bk * sin(theta)
    d_x, d_y = -b2_x - linkage.ak_x, -b2_y - linkage.ak_y
    # S = 1 / D^2 and its two derivatives; u and w are functions of S alone.
    square = d_x * d_x + d_y * d_y
    square_1 = 2.0 * (d_x * b1_x + d_y * b1_y)
    square_2 = 2.0 * (b1_x * b1_x + b1_y * b1_y + d_x * b2_x + d_y * b2_y)
    s = 1.0 / square
    s_1 = -square_1 * s * s
    s_2 = (2.0 * square_1 * square_1 * s - square_2) * s * s
    half_difference = 0.5 * (linkage.ar * linkage.ar - linkage.br * linkage.br)
    u, u_1, u_2 = 0.5 + half_difference * s, half_difference * s_1, half_difference * s_2
    w = math.sqrt(linkage.ar * linkage.ar * s - u * u)
    w_1 = (0.5 * linkage.ar * linkage.ar * s_1 - u * u_1) / w
    w_2 = (0.5 * linkage.ar * linkage.ar * s_2 - u_1 * u_1 - u * u_2 - w_1 * w_1) / w
    e_x = linkage.ak_x + u * d_x + w * d_y - linkage.c_x
    e_y = linkage.ak_y + u * d_y - w * d_x - linkage.c_y
    r1_x = u_1 * d_x + u * b1_x + w_1 * d_y + w * b1_y
    r1_y = u_1 * d_y + u * b1_y - w_1 * d_x - w * b1_x
    r2_x = u_2 * d_x + 2.0 * u_1 * b1_x + u * b2_x + w_2 * d_y + 2.0 * w_1 * b1_y + w * b2_y
    r2_y = u_2 * d_y + 2.0 * u_1 * b1_y + u * b2_y - w_2 * d_x - 2.0 * w_1 * b1_x - w * b2_x
    length = math.sqrt(e_x * e_x + e_y * e_y)
    lever = (e_x * r1_x + e_y * r1_y) / length
    lever_1 = (r1_x * r1_x + r1_y * r1_y + e_x * r2_x + e_y * r2_y - lever * lever) / length
    return length - linkage.retracted_length, lever, lever_1


@kernel
def actuator_coordinate(q, linkage):
    """Return (x, r, dr/dq) of the joint's own kind of linkage  (L2)."""
    if linkage.kind == SLIDER_CRANK:
        return slider_crank(q, linkage)
    if linkage.kind == FOUR_BAR:
        return four_bar(q, linkage)
    return direct(q, linkage)


@kernel
def find_motion(angles, linkage, found):
    """Write coordinate and lever at each of n joint angles, rad, to ``found`` (2, n)  (L2)."""
    for k in range(len(angles)):
        found[0, k], found[1, k], _ = actuator_coordinate(angles[k], linkage)


def motion(angles: ArrayLike, linkage: np.record) -> NDArray[np.float64]:
    """Return the actuator's coordinate, and its lever, at each of n joint angles, (2, n)  (L2)."""
    places = np.array(angles, float)
    found = np.zeros((2, len(places)))
    find_motion(places, linkage, found)
    return found


def levers(angles: ArrayLike, linkage: np.record) -> list[float]:
    """Return the lever at each joint angle, rad: m or 1  (L2)."""
    values: list[float] = motion(angles, linkage)[1].tolist()
    return values


def rod_eye(q: float, linkage: np.record) -> tuple[float, float]:
    """Return R of a four-bar, the eye of the rod, in the thigh's frame, m  (L5)."""
    theta = linkage.sense * q + linkage.offset
    d_x = linkage.bk * cos(theta) - linkage.ak_x
    d_y = linkage.bk * sin(theta) - linkage.ak_y
    square = d_x * d_x + d_y * d_y
    u = 0.5 + 0.5 * (linkage.ar * linkage.ar - linkage.br * linkage.br) / square
    w = math.sqrt(linkage.ar * linkage.ar / square - u * u)
    return float(linkage.ak_x + u * d_x + w * d_y), float(linkage.ak_y + u * d_y - w * d_x)
