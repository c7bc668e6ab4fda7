"""Layers of values: what a later one replaces, and where each value comes from."""

from isa_ros.config.listing import sources
from isa_ros.config.text.sections import merge, Place, sourced, written
from isa_ros.errors import ConfigError
import pytest

RUN = Place('run.yaml') / 'parameters'
MODEL = Place('model.yaml')


def test_a_later_layer_replaces_single_values_only() -> None:
    base = sourced({
        'law': {'value': 'plain', 'source': 'assumed'},
        'gain': {'value': 1.0, 'source': 'paper Table 4'},
        'drive': {'kind': 'small', 'bore_mm': {'value': 21.5, 'source': 'paper Table 2'}}}, MODEL)
    merged = merge(base, written({'drive': {'bore_mm': 16.0}}, RUN))
    assert [layer['drive']['bore_mm'].value for layer in (base, merged)] == [  # type: ignore
        21.5, 16.0]
    assert sources(merged) == {
        'law': 'assumed', 'gain': 'paper Table 4', 'drive.kind': '', 'drive.bore_mm': 'run.yaml'}


@pytest.mark.parametrize('leaf, expected', [
    ({'value': 1.0}, 'model.yaml: gain needs a value and its source'),
    ({'value': 1.0, 'source': 'hearsay'}, "gain.source = 'hearsay', must start with paper or"),
    ({'value': 1.0, 'source': 'assumed', 'sauce': 1}, 'gain.sauce is unknown; did you mean'),
    (1.0, 'model.yaml: gain = 1.0, must be a section'),
])
def test_a_sheet_value_needs_its_source(leaf: object, expected: str) -> None:
    with pytest.raises(ConfigError, match=expected):
        sourced({'gain': leaf}, MODEL)  # type: ignore[dict-item]
