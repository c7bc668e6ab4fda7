"""The channels of a page in the rows of a run."""

import isa_ros
from isa_ros.view.columns import Columns
from isa_ros.view.panels import channels_of, groups_of
from isa_ros.view.scene import scene_of
import numpy as np
import pytest
from tests.view.test_scene import FOLDER


@pytest.mark.parametrize('name', ['leg', 'quadruped', 'pump_station'])
def test_each_channel_is_the_number_of_its_name(name):
    """At two ticks, from the same memory."""
    run = isa_ros.load(name)
    simulation, result = run.simulation(), run.simulate(0.004)
    channels = channels_of(groups_of(run.configuration), scene_of(run.configuration, FOLDER))
    assert len({*channels}) == len(channels) > 9
    columns = Columns(run.configuration, simulation.loop.rows, channels)
    for tick in range(1, 5):
        simulation.step()
        row = np.empty(len(channels), np.float32)
        columns.fill(row)
        for value, channel in zip(row, channels):
            column, _, place = channel.partition('[')
            own = result[column][tick]
            assert value == np.float32(own[int(place[:-1])] if place else own), channel
