"""Signals of a rig with a fault: cleared at its tick, and sampled at each."""

from isa_ros.analysis.faults.measure import BEGIN_S, chosen_faults, END_S
from isa_ros.analysis.faults.recorded import EXACT, recorded, STATE, STEP_S, SUPPLY
from isa_ros.analysis.faults.rigs import common_rigs
from isa_ros.core.device import DISABLED, ENABLED, FAULT
import numpy as np


def test_what_the_device_keeps_is_cleared_at_its_tick() -> None:
    """And enabled in the tick after it; without a time it stays in fault."""
    rig = next(iter(common_rigs()))
    fault, = chosen_faults(['valve_stuck'])
    given = ({**rig.tree(fault, BEGIN_S), 'until_s': END_S},)
    k = round(END_S / STEP_S) + 50
    found = recorded(rig, given, END_S + 0.1, k * STEP_S)
    assert found[STATE][k - 1:k + 3].tolist() == [FAULT, FAULT, DISABLED, ENABLED]
    assert len(found[SUPPLY]) == k + 51 and set(map(len, found.values())) == {k + 51}
    kept = recorded(rig, given, END_S + 0.1)
    assert kept[STATE][k:].tolist() == [FAULT] * 51
    for name in EXACT:
        assert np.array_equal(kept[name][:k + 1], found[name][:k + 1])
        assert len(set(found[name].tolist())) > 100
