"""Saved states of a library: damage is refused, as is what has diverged."""

import ctypes
import re

from isa_ros.actuator.actuator import SmartActuator
from isa_ros.actuator.integration import STATE_SIZE
from isa_ros.config.assembly import timing_of
from isa_ros.errors import ConfigError
import numpy as np
import pytest
from tests.export.calls import NOT_FINITE, port, WRONG_SIZE, WRONG_STATE
from tests.export.libraries import BEHIND, Instance, sealed

pytestmark = pytest.mark.slow


def test_a_divergence_stays_until_the_next_start(loaded):
    instance = Instance(loaded)
    state = instance.save()
    code = instance.tick(port(v0=1e300))
    assert 0 < code <= STATE_SIZE
    message = loaded.message(code)
    assert re.fullmatch(r'[a-z_.0-9]+ is not finite: the model has diverged', message)
    t_ns = instance.t_ns
    assert instance.tick(port()) == code and instance.t_ns == t_ns
    size = ctypes.c_size_t(len(state))
    assert loaded.call('save', instance.memory, state.copy(), size) == NOT_FINITE
    assert instance.restore(state) == 0 and instance.tick(port()) == 0
    assert instance.tick(port(v0=1e300)) == code and instance.start() == 0
    assert instance.tick(port()) == 0


def test_what_was_drawn_from_a_feed_is_saved(loaded):
    """The next feed is made of it, in an instance that had another one too."""
    feed = 1e9, 1e-5, 0.0, 0.0, 1.0, 2e-6, 0.0, 0.0
    one, other = Instance(loaded), Instance(loaded)
    assert one.tick(port(), feed=feed) == 0
    state, fed = one.save(), one.fed.tobytes()
    assert other.tick(port(x0=0.0501), feed=feed) == 0
    for instance in (Instance(loaded), other):
        assert instance.fed.tobytes() != fed
        assert instance.restore(state) == 0 and instance.fed.tobytes() == fed
        assert instance.save().tobytes() == state.tobytes()


def test_nothing_of_a_divergence_remains_after_a_restore(loaded):
    """The rates of its last step are not in a state, but those of a feed that is gone stay."""
    instance = Instance(loaded)
    state = instance.save()
    assert instance.tick(port(v0=1e300), feed=(1e9, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0)) > 0
    assert instance.restore(state) == 0 and instance.tick(port()) == 0
    fresh = Instance(loaded)
    assert fresh.tick(port()) == 0 and fresh.save().tobytes() == instance.save().tobytes()


def test_the_state_that_diverged_is_named(loaded, own):
    """As the error of Python names it."""
    from isa_ros.errors import SimulationDiverged
    actuator = SmartActuator(own.chosen.config, timing_of(own.chosen.run))
    with pytest.raises(SimulationDiverged) as error:
        actuator.tick(port(v0=1e300))
    message = loaded.message(Instance(loaded).tick(port(v0=1e300)))
    assert message.startswith(error.value.field.removeprefix('isa_v5: ') + ' is not finite')


def test_states_that_are_refused(loaded, own):
    """Another size, another time, numbers that no state has, and those of another actuator."""
    instance = Instance(loaded)
    for k in range(20):
        instance.tick(port(x0=0.05 + 1e-5 * k))
    state = instance.save()
    assert instance.restore(state[:-1]) == WRONG_SIZE
    assert loaded.call('save', instance.memory, state.copy(), ctypes.c_size_t(8)) == WRONG_SIZE

    def changed(at, value):
        wrong = state.copy()
        wrong[at:at + 8] = np.frombuffer(np.array(value).tobytes(), np.uint8)
        return sealed(wrong)
    assert sealed(state).tobytes() == state.tobytes()
    for t_ns in (-1_000_000, 500_000, 2**32 * 1_000_000):
        assert instance.restore(changed(0, t_ns)) == WRONG_STATE
    assert instance.restore(changed(0, (2**32 - 1) * 1_000_000)) == 0
    assert instance.restore(state) == 0
    before = bytes(instance.memory)
    assert instance.restore(changed(8, np.nan)) == WRONG_STATE
    assert instance.restore(changed(len(state) - 16, np.inf)) == WRONG_STATE    # heat
    for at in (len(state) - 48, len(state) - 56, len(state) - 64):
        assert instance.restore(changed(at, 7)) == WRONG_STATE
    for at in (len(state) - 41, len(state) - BEHIND - own.actuator.tuning.nbytes):
        wrong = state.copy()
        wrong[at] ^= 1
        assert instance.restore(sealed(wrong)) == WRONG_STATE
    assert bytes(instance.memory) == before
    assert instance.restore(state) == 0 and instance.save().tobytes() == state.tobytes()


def test_damaged_states_are_refused(loaded):
    """Every single bit; two signs; two words that are exchanged."""
    instance = Instance(loaded)
    for k in range(20):
        instance.tick(port(x0=0.05 + 1e-5 * k))
    state, before = instance.save(), bytes(instance.memory)
    for at in range(len(state)):
        for bit in range(8):
            state[at] ^= 1 << bit
            assert instance.restore(state) == WRONG_STATE, (at, bit)
            state[at] ^= 1 << bit
    words = state.view(np.uint64)
    one, other = np.flatnonzero(words[1:-10])[[3, 40]] + 1
    assert words[one] != words[other]
    damaged = words.copy()
    damaged[[one, other]] ^= np.uint64(1 << 63)
    assert instance.restore(damaged.view(np.uint8)) == WRONG_STATE
    damaged = words.copy()
    damaged[[one, other]] = words[[other, one]]
    assert instance.restore(damaged.view(np.uint8)) == WRONG_STATE
    assert bytes(instance.memory) == before and instance.restore(state) == 0


def test_altered_states_are_refused_as_in_python(loaded, own):
    """A number of a state at a time; what is taken is taken by both."""
    actuator = SmartActuator(own.chosen.config, timing_of(own.chosen.run))
    instance = Instance(loaded)
    for k in range(20):
        given = port(x0=0.05 + 1e-5 * k)
        instance.tick(given)
        actuator.tick(given)
    state = instance.save()
    end = len(state) - BEHIND - actuator.tuning.nbytes
    odd = [np.array(value).tobytes() for value in (np.nan, -1, 8, 300, 2**31)]
    taken = 0
    for at in range(0, end, 8):
        for text in odd:
            wrong = state.copy()
            wrong[at:at + 8] = np.frombuffer(text, np.uint8)
            try:
                actuator.restore(wrong[:-BEHIND].tobytes())
                expected = 0
            except ConfigError:
                expected = WRONG_STATE
            assert instance.restore(sealed(wrong)) == expected, (at, text)
            taken += expected == 0
    assert 0 < taken < end
