"""Links of run files: for all or for one, what they default to, and what fits on a wire."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from isa_ros.actuator.link import LinkSheet, NO_LINK
from isa_ros.config.listing import describe
from isa_ros.config.models.wires import refuse_overfull, wire
from isa_ros.config.paths import CONFIG, find
from isa_ros.config.runs.run_config import RunConfig
from isa_ros.config.runs.run_file import load_run
from isa_ros.config.runs.run_reading import run_of_text
from isa_ros.config.text.sections import Place
from isa_ros.errors import ConfigError
import pytest

LEG = find('leg.yaml', CONFIG)
PLACE = Place('leg.yaml')


def leg(**changes: Any) -> RunConfig:
    """Return the leg with other values; ``__`` stands for a dot."""
    return load_run(LEG, {key.replace('__', '.'): value for key, value in changes.items()})


def link_of(run: RunConfig, name: str) -> LinkSheet:
    return run.actuator(name).sheet.link


def on(kind: str, n: int, cycle_ms: float = 1.0) -> Mapping[str, LinkSheet]:
    """Return the links of ``n`` actuators on one wire."""
    link = replace(NO_LINK, kind=kind, cycle_ms=cycle_ms)
    return {f'a{k}': link for k in range(n)}


def fits(kind: str, n: int, cycle_ms: float = 1.0) -> bool:
    try:
        refuse_overfull(on(kind, n, cycle_ms), PLACE)
    except ConfigError:
        return False
    return True


def test_without_the_section_there_is_no_link():
    run = leg()
    assert run.linked == () and all(own.sheet.link == NO_LINK for own in run.actuators)


def test_a_link_is_for_all_and_an_actuator_changes_single_keys():
    run = leg(link={'kind': 'ethercat', 'delay_cycles': 1, 'loss': 0.1},
              actuators__kfe__link={'loss': 0.5}, actuators__haa__link__kind='none')
    assert run.linked == ('hfe', 'kfe')
    assert [link_of(run, name).loss for name in ('hfe', 'kfe')] == [0.1, 0.5]
    assert [link_of(run, name).delay_cycles for name in ('hfe', 'kfe')] == [1.0, 1.0]


def test_what_is_not_given_is_zero_and_the_cycle_then_the_tick():
    run = leg(link={'kind': 'ethercat'}, step_ms=2.0)
    assert link_of(run, 'kfe') == replace(NO_LINK, kind='ethercat', cycle_ms=2.0)


def test_the_keys_of_isa_params_are_taken_too():
    run = leg(link__kind='ethercat', actuators__kfe__parameters__link__loss=0.3)
    assert [link_of(run, name).loss for name in ('hfe', 'kfe')] == [0.0, 0.3]


def test_a_resolved_link_reads_back():
    run = leg(link={'kind': 'ethercat', 'cycle_ms': 0.25, 'loss': 0.1}, seed=7)
    assert run_of_text(run.to_yaml()) == run


@pytest.mark.parametrize('changes, message', [
    ({'link': 3}, 'leg.yaml: link = 3, must be a section'),
    ({'link': {'kind': 'ethercat', 'los': 0.1}}, 'leg.yaml: link.los is unknown; did you mean'),
    ({'link': {'kind': 'usb'}}, "link.kind = 'usb', must be one of none, ethercat, can, serial"),
    ({'link': {'kind': 'ethercat', 'loss': 'much'}}, "link.loss = 'much', must be a number"),
    ({'actuators.kfe.link.kind': ['can']}, 'leg.yaml: actuators.kfe.link.kind'),
    ({'link': {'kind': 'ethercat'}, 'actuators.kfe.link.cycle_ms': 2.0},
     'link.cycle_ms = 1 ms of haa and 2 ms of kfe, must be equal: one ethercat wire')])
def test_a_link_that_cannot_be_is_refused(changes, message):
    with pytest.raises(ConfigError) as refused:
        load_run(LEG, changes)
    assert message in str(refused.value) and '\n' not in str(refused.value)


def test_two_actuators_fit_on_can_at_1_khz_and_a_leg_of_three_does_not():
    """By hand: 4 frames of 47 bits, 26 bytes, and floor((34 + 8 s - 1)/4) stuff bits each."""
    bits = sum(47 + 8 * s + (34 + 8 * s - 1) // 4 for s in (5, 8, 5, 8))
    assert wire('can')[0].bits(1) == bits == 480
    assert fits('can', 2) and not fits('can', 3) and fits('can', 3, 1.44)
    assert not fits('can', 3, 1.42)


def test_a_leg_takes_about_17_us_on_ethercat():
    """156 bytes and 52 of the frame, at 100 Mbit/s."""
    own = wire('ethercat')[0]
    assert own.bits(3) / own.bit_rate_mbit == pytest.approx(16.64, rel=1e-12)
    assert fits('ethercat', 3, 0.02) and not fits('ethercat', 12, 0.05)


def test_more_than_a_frame_carries_goes_in_two():
    """Of 1486 bytes: 28 actuators, 1456 bytes."""
    own = wire('ethercat')[0]
    assert [own.frames(n) for n in (1, 28, 29, 57, 58)] == [1, 1, 2, 2, 3]
    assert own.bits(29) == (29 * 52 + 2 * 52) * 8


def test_the_refusal_has_the_arithmetic_of_a_shared_frame():
    with pytest.raises(ConfigError) as refused:
        refuse_overfull(on('ethercat', 12, 0.05), PLACE)
    assert str(refused.value).startswith(
        'leg.yaml: link.cycle_ms = 0.05 ms, must be >= 0.05408 ms')
    assert str(refused.value).endswith(
        'need 12 x 416 + 1 x 416 = 5408 bit, ethercat at 100 Mbit/s carries 5000 bit')


def test_wires_of_different_kinds_do_not_share_their_cycle():
    refuse_overfull({**on('can', 2), 'b': on('serial', 1)['a0']}, PLACE)


def test_isa_params_shows_link_and_wire(tmp_path):
    path = tmp_path / 'leg.yaml'
    path.write_text(LEG.read_text() + 'link: {kind: ethercat, loss: 0.25}\n')
    text = describe(str(path))
    assert 'wire of links: ethercat' in text and 'bit_rate_mbit' in text
    line = next(line for line in text.splitlines() if line.startswith('link.loss '))
    for cell in ('0.25', '>= 0, <= 1', 'leg.yaml', 'probability that a frame is lost'):
        assert cell in line
