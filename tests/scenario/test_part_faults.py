"""Faults of the parts of a circuit in a scenario: by name, by part, and what is refused."""

from collections.abc import Mapping
from typing import Any

import isa_ros
from isa_ros.config.models.fault_catalogue import fault_catalogue
from isa_ros.config.text.sections import Place
from isa_ros.errors import ConfigError
from isa_ros.scenario.fault_reading import read_faults
import pytest

STATION = isa_ros.load('pump_station').configuration
PRESS = isa_ros.load('press').configuration


def values(tree: Mapping[str, Any], run: Any = STATION) -> dict[str, float]:
    """Return the values of the only fault of a run of 1 s."""
    one, = read_faults([{'t_s': 0.5, **tree}], Place('s.yaml', 'faults'), run, 1000)
    return dict(one.values)


@pytest.mark.parametrize(('tree', 'expected'), [
    ({'supply': 'station', 'fault': 'pump_trip'}, {'parts.pump.speed_rpm': 0.0}),
    ({'supply': 'station', 'fault': 'supply_low'}, {'parts.pump.pressure_mpa': 10.0}),
    ({'supply': 'station', 'fault': 'return_blocked'}, {'parts.return_filter.clogged': 0.9}),
    ({'supply': 'station', 'part': 'tool_buffer', 'fault': 'accumulator_empty'},
     {'parts.tool_buffer.gas_lost': 1.0}),
    ({'supply': 'station', 'part': 'tool_tube', 'set': {'burst': 0.3}},
     {'parts.tool_tube.burst': 0.3}),
    ({'supply': 'station', 'set': {'parts.tool_tube.burst': 0.4}}, {'parts.tool_tube.burst': 0.4}),
    ({'supply': 'station', 'part': 'drain', 'fault': 'manifold_leaks',
      'set': {'leakage_lpm_per_mpa': 3.0}}, {'parts.drain.leakage_lpm_per_mpa': 3.0})])
def test_values_are_those_of_the_part(
        tree: dict[str, Any], expected: dict[str, float]) -> None:
    """A name alone where there is one part of its kind; `set` replaces its values."""
    assert values(tree) == expected


@pytest.mark.parametrize(('tree', 'said'), [
    ({'supply': 'station', 'fault': 'accumulator_empty'},
     "faults[0] lacks part: 'accumulator_empty' is one of a part of kind accumulator, of which "
     'the circuit has buffer, tool_buffer'),
    ({'supply': 'station', 'part': 'press', 'fault': 'accumulator_empty'},
     "faults[0].part = 'press' is of kind manifold, must be of kind accumulator for "
     "'accumulator_empty': buffer, tool_buffer"),
    ({'supply': 'station', 'part': 'bufer', 'fault': 'accumulator_empty'},
     "faults[0].part = 'bufer' is unknown; did you mean buffer or tool_buffer?"),
    ({'supply': 'station', 'fault': 'unloading_stuck'},
     "faults[0].fault = 'unloading_stuck' is one of a part of kind unloading, of which the "
     'circuit has none'),
    ({'supply': 'station', 'part': 'press_hose', 'set': {'brst': 0.2}},
     'faults[0].set: parts.press_hose.brst of station, a supply of kind circuit, is unknown'),
    ({'supply': 'statin', 'part': 'pump', 'set': {'stuck': 1}},
     "faults[0].supply = 'statin' is not a supply; did you mean station?"),
    ({'actuator': 'left', 'part': 'pump', 'fault': 'valve_stuck'},
     'faults[0].part is not used: only a supply that is a circuit has parts'),
    ({'actuator': 'left', 'fault': 'pump_worn'},
     "faults[0].fault = 'pump_worn' is a fault of the supply, must be one of the actuator"),
    ({'actuator': 'left', 'fault': 'cushion_a_blocked'},
     "faults[0].fault = 'cushion_a_blocked' sets plant.cushion_a.restriction_blocked, must be a "
     'fault of what left has')])
def test_what_does_not_fit_is_refused_in_one_line(tree: dict[str, Any], said: str) -> None:
    with pytest.raises(ConfigError) as refused:
        values(tree)
    assert said in str(refused.value) and '\n' not in str(refused.value)
    assert len(str(refused.value)) < 250


@pytest.mark.parametrize(('tree', 'said'), [
    ({'supply': 'supply', 'fault': 'pump_worn'},
     "faults[0].fault = 'pump_worn' is one of a part of kind pump, must be one of a supply of "
     'kind constant'),
    ({'supply': 'supply', 'part': 'pump', 'fault': 'supply_low'},
     'faults[0].part is not used: only a supply that is a circuit has parts'),
    ({'supply': 'supply', 'part': 'pump', 'set': {'pressure_mpa': 3.0}},
     'faults[0].part is not used: only a supply that is a circuit has parts')])
def test_a_supply_without_parts_has_no_faults_of_any(tree: dict[str, Any], said: str) -> None:
    with pytest.raises(ConfigError) as refused:
        values(tree, PRESS)
    assert said in str(refused.value)


def test_it_keeps_its_own_values_where_it_is_no_circuit() -> None:
    assert values({'supply': 'supply', 'fault': 'supply_low'}, PRESS) == {'pressure_mpa': 10.0}


def test_each_name_of_a_part_says_what_it_needs() -> None:
    """Keys of an actuator, or a kind of part; a meaning of its own; no key twice."""
    own = {name: one for name, one in fault_catalogue().items() if one.rig}
    assert len(own) == 39 and all(one.meaning for one in own.values())
    for one in own.values():
        assert bool(one.values) != bool(one.part_values), one.name
    seen = {(tuple(one.values.items()), one.part, tuple(one.part_values.items()))
            for one in own.values()}
    assert len(seen) == len(own)
