"""Generated leg dynamics: equal to Pinocchio from the same URDF, energy, regeneration."""

import importlib.util
import math
from pathlib import Path

from hypothesis import given, settings, strategies as st
from isa_ros.core.record import row_record
from isa_ros.surroundings.bodies.leg.dynamics import LEG_BODY, leg_terms
from isa_ros.surroundings.bodies.leg.sheet import body_record, STANDARD_GRAVITY
import numpy as np
import pytest
from tests.legs import leg_sheet

ROOT = Path(__file__).resolve().parents[4]
LEGS = ('hyq_real', 'hyq')
BODY = body_record(leg_sheet().body)[0]
BODIES = {name: body_record(leg_sheet(name).body)[0] for name in LEGS}
NAMES = ('z', 'haa', 'hfe', 'kfe')
# Sums of up to a hundred products: tens of ulps of the largest, more where forces cancel (h).
ROUNDING = 1e-14

angles = st.tuples(st.floats(-0.8, 0.5), st.floats(0.0, 2.2), st.floats(-2.8, 0.0))
speeds = st.tuples(*[st.floats(-8.0, 8.0)] * 4)


def mass_matrix(terms):
    """Return M as an array, shape (4, 4)."""
    m = np.zeros((4, 4))
    for i, row in enumerate(NAMES):
        for j, column in enumerate(NAMES[i:], i):
            m[i, j] = m[j, i] = getattr(terms, f'm_{row}_{column}')
    return m


def foot_jacobian(terms):
    """Return J of the foot as an array, shape (3, 4)."""
    j = np.zeros((3, 4))
    j[2, 0] = 1.0
    for k, name in enumerate(NAMES[1:], 1):
        for i, axis in enumerate('xyz'):
            j[i, k] = getattr(terms, f'j_{axis}_{name}', 0.0)
    return j


def bias(terms):
    """Return h, shape (4,)."""
    return np.array([getattr(terms, f'h_{name}') for name in NAMES])


@pytest.fixture(scope='module', params=LEGS)
def oracle(request):
    """Return Pinocchio with the model of a shipped URDF, and the leg's name."""
    pin = pytest.importorskip('pinocchio')
    model = pin.buildModelFromUrdf(str(ROOT / 'urdf' / f'{request.param}_leg.urdf'))
    model.gravity.linear = np.array([0.0, 0.0, -STANDARD_GRAVITY])
    assert [model.names[k] for k in range(1, 5)] == [
        'slider_joint', 'haa_joint', 'hfe_joint', 'kfe_joint']
    return pin, model, model.createData(), request.param


@settings(max_examples=200)
@given(q=angles, v=speeds)
def test_dynamics_equal_pinocchio(oracle, q, v):
    """L6-L8: M, h, foot, foot velocity and Jacobian from the URDF and from the data sheet."""
    pin, model, data, name = oracle
    q_all, v_all = np.array([0.7, *q]), np.array(v)
    terms = leg_terms(*q_all, *v_all, BODIES[name])
    reference = pin.crba(model, data, q_all)
    reference = np.triu(reference) + np.triu(reference, 1).T
    h = pin.rnea(model, data, q_all, v_all, np.zeros(4))
    foot = model.getFrameId('foot')
    jacobian = pin.computeFrameJacobian(
        model, data, q_all, foot, pin.ReferenceFrame.LOCAL_WORLD_ALIGNED)[:3]
    pin.framesForwardKinematics(model, data, q_all)
    size = max(1.0, np.abs(h).max())
    assert np.abs(mass_matrix(terms) - reference).max() < ROUNDING * 15.2
    assert np.abs(bias(terms) - h).max() < 100.0 * ROUNDING * size
    position = np.array([terms.foot_x, terms.foot_y, terms.foot_z])
    velocity = np.array([terms.foot_v_x, terms.foot_v_y, terms.foot_v_z])
    assert np.abs(position - data.oMf[foot].translation).max() < ROUNDING
    assert np.abs(foot_jacobian(terms) - jacobian).max() < ROUNDING
    assert np.abs(velocity - jacobian @ v_all).max() < ROUNDING * (1.0 + np.abs(v_all).max())


@pytest.mark.parametrize('name', LEGS)
@given(q=angles)
def test_mass_matrix_is_positive_definite(name, q):
    """Cholesky exists: the solve of the leg never divides by zero."""
    np.linalg.cholesky(mass_matrix(leg_terms(0.5, *q, 0.0, 0.0, 0.0, 0.0, BODIES[name])))


@pytest.mark.parametrize('name', LEGS)
@given(q=angles, v=speeds)
def test_coriolis_forces_do_no_work(name, q, v):
    """
    v^T (dM/dt v / 2 - c) = 0 for the velocity forces c = h(v) - h(0)  (L7).

    dM/dt by central differences over 2e-5 s: truncation 1e-10 |v|^3 times M''' below 2 kg m2,
    with |v|^3 up to 4096: 1e-6 of a power of the order of 1e3 W.
    """
    body = BODIES[name]
    terms = leg_terms(0.5, *q, *v, body)
    still = leg_terms(0.5, *q, 0.0, 0.0, 0.0, 0.0, body)
    e, v_all = 1e-5, np.array(v)
    moved = [mass_matrix(leg_terms(
        0.5, *(np.array(q) + s * e * v_all[1:]), 0.0, 0.0, 0.0, 0.0, body)) for s in (-1.0, 1.0)]
    rate = (moved[1] - moved[0]) / (2.0 * e)
    power = v_all @ (0.5 * rate @ v_all - (bias(terms) - bias(still)))
    assert abs(power) < 1e-5 * (1.0 + np.linalg.norm(v_all) ** 3)


def test_hanging_leg_weighs_what_the_paper_says():
    """Paper section 5.2: 10.2 kg of leg and 5 kg of slider fall (mass scale rounded to 0.840)."""
    terms = leg_terms(0.5, 0.0, 0.9, -1.8, 0.0, 0.0, 0.0, 0.0, BODY)
    assert terms.m_z_z == pytest.approx(15.2, abs=0.005)
    assert terms.h_z == pytest.approx(terms.m_z_z * STANDARD_GRAVITY, rel=1e-14)


@pytest.mark.parametrize(('name', 'hanging'), [
    ('hyq_real', [0.0, 0.117, 1.0 - 0.74]), ('hyq', [0.0, 0.0, 1.0 - 0.08 - 0.691])])
def test_signs_of_the_joints(name, hanging):
    """HAA > 0 moves the foot inward (right), HFE > 0 backward, straight leg hangs down."""
    def foot(*q):
        terms = leg_terms(1.0, *q, 0.0, 0.0, 0.0, 0.0, BODIES[name])
        return np.array([terms.foot_x, terms.foot_y, terms.foot_z])

    straight = foot(0.0, 0.0, 0.0)
    assert straight == pytest.approx(hanging, abs=1e-15)
    assert foot(0.1, 0.0, 0.0)[1] < straight[1]
    assert foot(0.0, 0.1, 0.0)[0] < 0.0
    assert foot(0.0, 0.0, -0.1)[0] > 0.0


@given(q=angles, v=speeds)
def test_compiled_kernel_equals_its_python_source(q, v):
    """Replay depends on it: the jit must not reorder a rounding."""
    row = BODY.copy()
    assert leg_terms(0.7, *q, *v, row) == leg_terms.py_func(
        0.7, *q, *v, row_record(np.array([row], LEG_BODY)))


def test_generated_file_is_what_the_script_writes():
    """The equations are never edited by hand."""
    spec = importlib.util.spec_from_file_location(
        'generate_leg', ROOT / 'scripts' / 'generate_leg.py')
    script = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(script)
    assert script.generate().encode() == script.TARGET.read_bytes()
    assert '**' not in script.generate()


def test_urdf_limits_are_the_data_sheet_s(oracle):
    """Joint ranges of URDF (six decimals) and data sheet."""
    _, model, _, leg = oracle
    sheet = leg_sheet(leg)
    for k, name in enumerate(NAMES[1:], 1):
        joint = getattr(sheet, name)
        assert math.degrees(model.lowerPositionLimit[k]) == pytest.approx(joint.low_deg, abs=3e-5)
        assert math.degrees(model.upperPositionLimit[k]) == pytest.approx(joint.high_deg, abs=3e-5)
