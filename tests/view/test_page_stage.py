"""The machine on the page: poses, patches and pixels."""

from pathlib import Path

import isa_ros
from isa_ros.scripting.result import Result
import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from tests.bag.golden import GOLDEN
from tests.browser import Browser
from tests.view.pages import choose, CLOCK, played

SOLID = """
    const canvas = document.querySelector('#stage canvas'), g = canvas.getContext('2d');
    const {data} = g.getImageData(0, 0, canvas.width, canvas.height);
    let n = 0, x = 0, y = 0;
    for (let k = 0; k < data.length; k += 4) if (data[k + 3] > 250) {
      n++; x += k / 4 % canvas.width; y += Math.floor(k / 4 / canvas.width); }
    return [n, x / n / canvas.width, y / n / canvas.height]"""


@pytest.fixture(scope='module')
def drop(tmp_path_factory: pytest.TempPathFactory) -> tuple[Result, Path]:
    """Return a leg that falls, and its bag."""
    result = isa_ros.load('leg', 'drop').simulate(0.4)
    return result, result.save(tmp_path_factory.mktemp('view') / 'bag')


def pixels_of(browser: Browser) -> list[float]:
    """Return how much of the stage is solid, and its middle."""
    found: list[float] = browser.run(SOLID)
    return found


def test_the_machine_is_drawn_and_moves(browser, drop):
    """The leg falls by some centimetres; the mouse turns the view, a double click undoes it."""
    with played(drop[1]) as url:
        browser.visit(url)
        browser.wait(f'{CLOCK} === 0.4')
        choose(browser, 'seek', 0.0)
        browser.wait(f'{CLOCK} === 0')
        high = pixels_of(browser)
        choose(browser, 'seek', 0.3)
        browser.wait(f'{CLOCK} === 0.3')
        low = pixels_of(browser)
        assert min(high[0], low[0]) > 2000
        assert low[2] - high[2] > 0.03 and abs(low[1] - high[1]) < 0.02
        browser.move('#stage canvas', 0, 0, then_to=80)
        browser.wait(f'return Math.abs((() => {{{SOLID}}})()[1] - {low[1]}) > 0.01')
        browser.run("document.querySelector('#stage canvas').dispatchEvent(new Event('dblclick'))")
        browser.wait(f'return (() => {{{SOLID}}})()[0] === {low[0]}')


def test_the_pose_is_that_of_the_joints(browser, drop):
    """The page's frame of the foot, against the place of the foot in the run."""
    result, bag = drop
    with played(bag) as url:
        browser.visit(url)
        browser.wait(f'{CLOCK} === 0.4')
        x, y, z = browser.run("""
            return fetch('page.json').then(own => own.json()).then(meta => new Promise(done => {
              const stage = new Stage(document.createElement('div'), meta.scene);
              const source = new EventSource('frames');
              source.onmessage = event => {
                const frame = JSON.parse(event.data), store = new Store(meta.channels, meta.step);
                if (frame.first !== 150 || !frame.n) return;
                source.close();
                store.add(frame);
                stage.pose(channel => store.last[channel]);
                done(stage.frames[meta.scene.findIndex(node => node.name === 'foot')].place);
              };
              source.onopen = () => order('seek', { value: 0.15 });
            }))""")
    # angles and height are float32: 1e-7 of about 1 m
    assert [x, y, z] == pytest.approx(result['body.foot_position'][150].tolist(), abs=1e-6)


def test_frames_turn_and_slide_as_their_channels_say(browser):
    """A free root, a joint about an oblique axis and a slider, against rotations of scipy."""
    place, own = [0.3, -0.2, 0.7], Rotation.from_euler('xyz', [0.4, -0.7, 1.1])
    axis = np.array([2.0, -1.0, 2.0]) / 3.0
    nodes = [
        {'parent': -1, 'place': [0.0, 1.5, 0.0], 'motion': 'fixed', 'channels': []},
        {'parent': 0, 'place': [0.0] * 3, 'motion': 'free', 'channels': [*range(7)]},
        {'parent': 1, 'place': place, 'motion': 'turn', 'axis': axis.tolist(), 'channels': [7],
         'rotation': own.as_matrix().ravel().tolist()},
        {'parent': 2, 'place': [0.1, 0.2, 0.3], 'motion': 'slide', 'axis': [0.0, 0.6, 0.8],
         'channels': [8], 'rotation': own.as_matrix().ravel().tolist()}]
    nodes = [{'name': '', 'shapes': [], 'reach': 0, 'axis': [0.0, 0.0, 1.0],
              'rotation': np.eye(3).ravel().tolist(), **node} for node in nodes]
    free = Rotation.from_euler('xyz', [-0.3, 0.5, 2.0])
    pose = [1.0, 2.0, 3.0, *free.as_quat()[[3, 0, 1, 2]], 0.9, 0.25]
    with played(GOLDEN / 'rotor_step') as url:
        browser.visit(url)
        frames = browser.run("""
            const stage = new Stage(document.createElement('div'), arguments[0]);
            stage.pose(channel => arguments[1][channel]);
            return stage.frames.map(own => [own.place, own.turn])""", nodes, pose)
    joint = free * own * Rotation.from_rotvec(0.9 * axis)
    trunk = np.array([1.0, 3.5, 3.0])
    link = trunk + free.apply(place)
    tip = link + joint.apply(np.array([0.1, 0.2, 0.3]) + own.apply([0.0, 0.15, 0.2]))
    for (at, turn), expected, rotation in zip(frames[1:], (trunk, link, tip), (
            free, joint, joint * own)):
        np.testing.assert_allclose(at, expected, rtol=0.0, atol=1e-12)
        np.testing.assert_allclose(
            np.reshape(turn, (3, 3)), rotation.as_matrix(), rtol=0.0, atol=1e-12)


def test_patches_look_outwards_and_cover_their_shapes(browser):
    """Their areas add up to those of box, cylinder and sphere of 20 sides and 8 rings."""
    with played(GOLDEN / 'rotor_step') as url:
        browser.visit(url)
        found = browser.run("""
            return arguments[0].map(shape => patchesOf(shape, 0.1).map(points => {
              const n = normalOf(points), middle = scaled(points.reduce(add), 1 / points.length);
              let area = 0;
              for (let k = 1; k + 1 < points.length; k++) {
                const u = add(points[k], scaled(points[0], -1));
                const v = add(points[k + 1], scaled(points[0], -1));
                area += Math.hypot(u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2],
                                   u[0] * v[1] - u[1] * v[0]) / 2;
              }
              return [dot(n, middle) > 0, area];
            }))""", [{'kind': 'box', 'size': [0.3, 0.5, 0.7]},
                     {'kind': 'cylinder', 'size': [0.2, 0.9]}, {'kind': 'sphere', 'size': [0.4]}])
    side = 2 * 20 * 0.2 * np.sin(np.pi / 20)
    exact = [2 * (0.15 + 0.21 + 0.35), side * 0.9 + 20 * 0.04 * np.sin(np.pi / 10),
             4 * np.pi * 0.16]
    for patches, area, tolerance in zip(found, exact, (1e-9, 1e-9, 0.05)):
        assert all(is_outward for is_outward, _ in patches)
        assert sum(own for _, own in patches) == pytest.approx(area, rel=tolerance)
