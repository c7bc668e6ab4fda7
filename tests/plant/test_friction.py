"""LuGre friction: break-away, Coulomb level, dissipation."""

import math

from hypothesis import given, strategies as st
from isa_ros.plant import friction
import pytest
from tests.sheets import plant_row

SEALS = [plant_row('smart_manifold').friction, plant_row('isa_v5').friction]
BOTH = pytest.mark.parametrize('seal', SEALS, ids=['manifold', 'v5'])


@BOTH
def test_stiction_at_rest_and_coulomb_at_speed(seal):
    """F1: g(0) is the stiction level, g at ten Stribeck speeds the Coulomb level."""
    assert friction.stribeck(0.0, seal) == seal.stiction
    assert friction.stribeck(10.0 * seal.v_s, seal) == pytest.approx(seal.coulomb, rel=1e-12)


@BOTH
def test_steady_sliding_force(seal):
    """F2, F3: where z' = 0 the force is g(v) + sigma_2 v."""
    v = 0.2
    z = friction.stribeck(v, seal) / seal.sigma0
    rate = friction.bristle_rate(v, z, seal)
    assert rate == pytest.approx(0.0, abs=1e-12)
    assert friction.friction_force(v, z, rate, seal) == pytest.approx(
        friction.stribeck(v, seal) + seal.sigma2 * v, rel=1e-9)


@BOTH
def test_bristle_never_exceeds_the_stiction_deflection(seal):
    """F2: at |z| = g(v)/sigma_0 the bristle stops growing, so |z| <= F_s/sigma_0 holds."""
    limit = seal.stiction / seal.sigma0
    for v in (1e-6, 1e-3, 0.1, 2.0):
        assert friction.bristle_rate(v, limit, seal) <= 1e-15
        assert friction.bristle_rate(-v, -limit, seal) >= -1e-15


@given(v=st.floats(-3.0, 3.0), share=st.floats(-1.0, 1.0))
def test_friction_is_odd(v, share):
    """Reversing speed and bristle reverses the force exactly."""
    for seal in SEALS:
        z = share * seal.stiction / seal.sigma0
        force = friction.friction_force(v, z, friction.bristle_rate(v, z, seal), seal)
        back = friction.friction_force(-v, -z, friction.bristle_rate(-v, -z, seal), seal)
        assert back == -force


@given(v=st.floats(-3.0, 3.0), share=st.floats(-1.0, 1.0))
def test_compiled_friction_equals_its_python_source(v, share):
    """The exponential included."""
    seal = SEALS[1]
    z = share * seal.stiction / seal.sigma0
    rate = friction.bristle_rate(v, z, seal)
    assert rate == friction.bristle_rate.py_func(v, z, seal)
    assert math.isfinite(rate)
