"""The examples run, and show what their first lines promise."""

import hashlib

from isa_ros.examples import over_a_link, same_bytes, sweep_dead_volume, two_gains
import numpy as np
import pytest


def test_two_gains_are_drawn_over_each_other(tmp_path, capsys):
    """Both end at the reference; half the gain overshoots more."""
    results = two_gains.results()
    ends = [result['ram.force'][-1] for result in results.values()]
    assert ends == pytest.approx([two_gains.STEP] * 2, rel=0.01)  # ripple of the converters
    full, half = (result['ram.force'].max() for result in results.values())
    assert half > full > two_gains.STEP
    two_gains.main([str(tmp_path / 'two.png')])
    assert (tmp_path / 'two.png').read_bytes().startswith(b'\x89PNG')
    assert capsys.readouterr().out.strip().endswith('two.png')


def test_an_impedance_over_a_link_is_softer_than_that_of_the_reu():
    """With 8 ms each way 1e5 N/m do not settle in the commander; without a link and in the REU."""
    stiffness = 1e5
    assert not over_a_link.settles(over_a_link.Remote(stiffness), 8)
    assert over_a_link.settles(over_a_link.Remote(stiffness), 0)
    assert over_a_link.settles(over_a_link.Own(stiffness), 8)


@pytest.mark.slow
def test_the_sweep_has_a_row_for_each_height_and_volume():
    """A higher drop lands harder, whatever the dead volume."""
    table = sweep_dead_volume.table(workers=2)
    peaks = np.array(table['peak, N']).reshape(2, 3)
    assert (peaks[1] > peaks[0]).all()


@pytest.mark.slow
@pytest.mark.ros
def test_a_controller_gives_the_same_bytes_in_memory_and_as_a_node(domain, tmp_path, capfd):
    same_bytes.main([str(tmp_path)])
    printed = capfd.readouterr().out.split()
    files = [next((tmp_path / name).glob('*.mcap')) for name in ('in_memory', 'on_nodes')]
    assert {hashlib.sha256(file.read_bytes()).hexdigest() for file in files} == {
        word for word in printed if len(word) == 64}
    assert len({file.read_bytes() for file in files}) == 1
