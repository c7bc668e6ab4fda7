"""Loads of a single actuator: stops, pads with the ground's law, no force without them."""

from dataclasses import replace
from functools import cache

from hypothesis import given, strategies as st
from isa_ros.core.contact import normal_force
from isa_ros.core.record import row_record
from isa_ros.errors import ParameterError
from isa_ros.loads import forces as own
from isa_ros.loads.forces import LOAD_STATE
from isa_ros.loads.sheets import own_record
from isa_ros.surroundings.ground import GROUND
import numpy as np
import pytest
from tests.sheets import MODELS, own_load, setpoint, smart_actuator

MATERIALS = ('metal', 'rubber', 'wood')
turns = st.floats(-0.02, 0.02)
speeds = st.floats(-3.0, 3.0)


@cache
def row(model, load):
    """Return the `OWN_LOAD` record of one of a model's loads."""
    return row_record(own_record(own_load(model, load)))


def state(position=0.0, velocity=0.0):
    """Return one `LOAD_STATE`."""
    rows = np.zeros(1, LOAD_STATE).view(np.recarray)
    rows['position'], rows['velocity'] = position, velocity
    return rows[0]


@pytest.mark.parametrize('material', MATERIALS)
@given(turn=turns, v=speeds)
def test_pad_is_the_ground_at_a_radius(material, turn, v):
    """L21: the force of the ground's law (L9) at depth R (x - x_0 - gap), and its torque."""
    pad = row('smart_manifold', material).pad
    ground = np.zeros(1, GROUND).view(np.recarray)
    ground['stiffness'], ground['damping'] = pad.stiffness, pad.damping
    depth, rate = 0.2 * turn, 0.2 * v
    assert own.pad_force(turn, v, pad) == -0.2 * normal_force(-depth, -rate, ground[0])


@pytest.mark.parametrize('model', MODELS)
@given(turn=turns, v=speeds)
def test_pad_never_pulls(model, turn, v):
    """L21: one-sided; no force within the gap."""
    pad = row(model, 'rubber').pad.copy()
    pad.gap = 0.005
    force = own.pad_force(turn, v, pad)
    assert force <= 0.0
    assert turn > 0.005 or force == 0.0
    assert force == own.pad_force.py_func(turn, v, pad)


def test_materials_stiffen_with_load_and_differ_by_their_names():
    """At 3 kN: wood 1e6 N/m, rubber a fifth of it, metal five times; twice that at 24 kN."""
    slopes = {}
    for name in MATERIALS:
        pad = row('isa_v5', name).pad
        for load in (3e3, 24e3):
            depth = (load / pad.stiffness) ** (2.0 / 3.0)
            e = 1e-6 * depth
            slopes[name, load] = (own.pad_force(depth - e, 0.0, pad)
                                  - own.pad_force(depth + e, 0.0, pad)) / (2.0 * e)
    # Central differences over 2e-6 of the depth: 1e-12 of truncation, 1e-10 of rounding.
    # 1.5 (k^2 N)^(1/3) with k = 1e7, 1e6 and 1e8 N/m^1.5 in the round figures above.
    assert slopes['wood', 3e3] == pytest.approx(1e6, rel=0.005)
    assert slopes['wood', 3e3] / slopes['rubber', 3e3] == pytest.approx(10 ** (2 / 3), rel=1e-9)
    assert slopes['metal', 3e3] / slopes['wood', 3e3] == pytest.approx(10 ** (2 / 3), rel=1e-9)
    for name in MATERIALS:
        assert slopes[name, 24e3] / slopes[name, 3e3] == pytest.approx(2.0, rel=1e-9)


@pytest.mark.parametrize(('model', 'effort'), [('isa_v5', 3000.0), ('smart_manifold', 50.0)])
@pytest.mark.parametrize('material', MATERIALS)
def test_actuator_pushes_on_the_pad_with_the_force_it_is_told(model, material, effort):
    """
    At rest the sensor reads the pad's force, and the pad's depth follows from its law.

    The slowest, 50 kg on rubber, halves its swing of 1500 N every 0.15 s: 0.2 N after 2 s. The
    rest is the force sensor's code, 10 kN | 200 Nm over 2048. The depth is compared with the force
    at that instant, at speeds below 1e-4 m/s: the law's damping is below 1e-4 of it.
    """
    actuator = smart_actuator(model, material)
    start = actuator._body.load.position
    actuator.accept(setpoint(position=start, stiffness=0.0, damping=0.0, effort=effort))
    for _ in range(20_000):
        actuator.tick()
    code = 2.0 * {'isa_v5': 1e4, 'smart_manifold': 200.0}[model] / 4096.0
    assert actuator.reply.force == pytest.approx(effort, abs=2.0 * code)
    pad = actuator._constants.load.pad
    depth = (actuator.reply.force / pad.radius / pad.stiffness) ** (2.0 / 3.0)
    assert pad.radius * (actuator._body.load.position - start) == pytest.approx(depth, rel=1e-3)


def test_stops_of_the_wheel_act_from_both_sides():
    """M3: one-sided springs beyond the ends, no force between them."""
    stops = row('smart_manifold', 'wheel').stops
    inside = own.stop_force(0.5 * (stops.low + stops.high), 3.0, stops)
    assert inside == 0.0
    assert own.stop_force(stops.high + 0.01, 0.0, stops) == pytest.approx(-500.0, rel=1e-12)
    assert own.stop_force(stops.low - 0.01, 0.0, stops) == pytest.approx(500.0, rel=1e-12)
    # 20 Nms/rad more against motion into the stop
    assert own.stop_force(stops.high + 0.01, 2.0, stops) == pytest.approx(-540.0, rel=1e-12)
    assert own.stop_force(stops.low - 0.01, -2.0, stops) == pytest.approx(540.0, rel=1e-12)


@pytest.mark.parametrize('load', ['mass', 'blocked'])
@given(position=st.floats(-1.0, 3.0), velocity=speeds)
def test_a_load_without_any_of_them_feels_none(load, position, velocity):
    """The record is all zeros."""
    y, rates = state(position, velocity), state()
    assert own.own_load_force(y, 0.5, row('smart_manifold', load), rates) == 0.0
    assert rates.weight.fall == rates.weight.velocity == 0.0


@pytest.mark.parametrize('load', ['wheel', 'drop_rig', 'rubber'])
@given(position=st.floats(-0.5, 2.5), velocity=speeds)
def test_compiled_kernel_equals_its_python_source(load, position, velocity):
    """Replay depends on equal bits."""
    y, rates = state(position, velocity), state()
    record = row('smart_manifold', load)
    assert (own.own_load_force(y, 0.8, record, rates)
            == own.own_load_force.py_func(y, 0.8, record, rates))


@pytest.mark.parametrize(('name', 'value', 'bound'), [
    ('gap', -0.1, '>= 0 '), ('radius', 0.0, '> 0 '), ('stiffness', 0.0, '> 0 '),
    ('damping', -0.1, '>= 0 '), ('inertia', 0.0, '> 0 ')])
def test_a_value_outside_its_range_is_refused(name, value, bound):
    """The message has the parameter and the bound."""
    with pytest.raises(ParameterError, match=f'Pad.{name} = .*must be {bound}'):
        replace(own_load('isa_v5', 'wood'), **{name: value})
