"""The page in a browser: a bag plays, a run is changed, and no markup becomes script."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from queue import Queue
import re
import threading

import isa_ros
from isa_ros.bag.reader import Bag
from isa_ros.config.paths import CONFIG, find
from isa_ros.replay.replay import replay
from isa_ros.run.coordinator import Interrupted
from isa_ros.run.options import Request
from isa_ros.run.session import prepare
from isa_ros.scripting.result import Result
from isa_ros.view.playing import Player
from isa_ros.view.running import view_run
from isa_ros.view.server import serving
import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from tests.bag.golden import GOLDEN, rewrite
from tests.browser import Browser, chromium

EVIL = '<script>window.hacked = 1<script><img src=x onerror="window.hacked = 2">'
CLOCK = "return parseFloat(document.getElementById('clock').textContent)"
SOLID = """
    const canvas = document.querySelector('#stage canvas'), g = canvas.getContext('2d');
    const {data} = g.getImageData(0, 0, canvas.width, canvas.height);
    let n = 0, x = 0, y = 0;
    for (let k = 0; k < data.length; k += 4) if (data[k + 3] > 250) {
      n++; x += k / 4 % canvas.width; y += Math.floor(k / 4 / canvas.width); }
    return [n, x / n / canvas.width, y / n / canvas.height]"""


@pytest.fixture(scope='module')
def browser() -> Iterator[Browser]:
    with chromium() as own:
        yield own


@pytest.fixture(scope='module')
def drop(tmp_path_factory: pytest.TempPathFactory) -> tuple[Result, Path]:
    """Return a leg that falls, and its bag."""
    result = isa_ros.load('leg', 'drop').simulate(0.4)
    return result, result.save(tmp_path_factory.mktemp('view') / 'bag')


@contextmanager
def played(bag: Path) -> Iterator[str]:
    """Play a bag meanwhile; yield the address of its page."""
    player, ended = Player(bag, Path()), threading.Event()
    thread = threading.Thread(target=player.play, args=(ended.is_set,))
    with serving(player.hub, 0) as url:
        thread.start()
        try:
            yield url
        finally:
            ended.set()
            thread.join()


def click(browser: Browser, name: str) -> None:
    browser.run(f"document.getElementById('{name}').click()")


def choose(browser: Browser, name: str, value: object) -> None:
    browser.run(
        'const own = document.getElementById(arguments[0]); own.value = arguments[1];'
        'for (const kind of ["input", "change"]) own.dispatchEvent(new Event(kind))',
        name, str(value))


def complaints(browser: Browser) -> list[str]:
    """Return the messages of the console, less those about how a test reads pixels."""
    return [line for line in browser.log() if 'getImageData' not in line]


def pixels_of(browser: Browser) -> list[float]:
    """Return how much of the stage is solid, and its middle."""
    found: list[float] = browser.run(SOLID)
    return found


def test_a_bag_plays_to_its_end_and_is_stepped_and_sought(browser):
    """In a large and a small window nothing is wider than the window."""
    with played(GOLDEN / 'leg_touchdown') as url:
        browser.visit(url)
        browser.wait(f'{CLOCK} === 0.08')
        assert browser.run("return document.getElementById('pause').textContent") == 'go on'
        choose(browser, 'seek', 0.05)
        browser.wait(f'{CLOCK} === 0.05')
        click(browser, 'step')
        browser.wait(f'{CLOCK} === 0.051')
        for width in (1300, 500):
            browser.resize(width, 900)
            browser.wait('return [...document.querySelectorAll(".chart")].every('
                         'own => own.clientWidth < innerWidth)')
            browser.wait('return document.documentElement.scrollWidth <= innerWidth')
        browser.resize(1300, 900)
        assert browser.log() == []


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


def test_missing_frames_are_a_gap_and_another_begin_forgets(browser):
    """In the store of the page; the grid finds the sample of a time."""
    with played(GOLDEN / 'rotor_step') as url:
        browser.visit(url)
        found = browser.run("""
            const store = new Store(2, 0.5), told = [];
            const frame = (first, every, ...values) => store.add({ first, every,
              n: values.length / 2,
              y: btoa(String.fromCharCode(...new Uint8Array(new Float32Array(values).buffer))) });
            const tell = () => told.push([[...store.ticks.slice(0, store.n)],
              [...store.columns[1].slice(0, store.n)].map(v => Number.isNaN(v) ? null : v)]);
            frame(10, 1, 1, 2, 3, 4);
            frame(12, 2, 5, 6, 7, 8);
            frame(20, 1, 9, 10);
            tell();
            told.push([store.grid.at(6.9), store.grid.at(7), store.grid.t(3)]);
            frame(4, 1, 11, 12);
            tell();
            for (let k = 0; k < 70000; k += 1000) {
              frame(100 + k, 1, ...Array.from({ length: 2000 }, (_, i) => k + (i >> 1)));
            }
            told.push([store.n <= 60000, store.ticks[store.n - 1], store.last[0]]);
            return told""")
    assert found == [
        [[10, 11, 12, 14, 15, 20], [2, 4, 6, 8, None, 10]], [3, 3, 7.0], [[4], [12]],
        [True, 70099, 69999]]


def test_of_many_values_meanwhile_the_last_is_sent(browser):
    """One order of a slider at a time."""
    with played(GOLDEN / 'rotor_step') as url:
        browser.visit(url)
        assert browser.run("""
            const posts = [], open = [];
            const send = sending(value => new Promise(done => {
              posts.push(value);
              open.push(done); }));
            send(1); send(2); send(3);
            const before = [...posts];
            open[0]();
            return new Promise(done => setTimeout(() => done([before, posts])))""") == [
                [1], [1, 3]]


def test_a_source_is_chosen_and_its_curves_have_their_values(browser):
    with played(GOLDEN / 'leg_touchdown') as url:
        browser.visit(url)
        browser.wait(f'{CLOCK} === 0.08')
        choose(browser, 'source', 3)
        labels = browser.run("return [...document.querySelectorAll('.chart')].map("
                             "own => own.getAttribute('aria-label'))")
        assert labels == ['contact force, N']
        choose(browser, 'source', 2)
        assert browser.run("return document.querySelectorAll('.chart').length") == 5
        result = isa_ros.read(GOLDEN / 'leg_touchdown')
        text = browser.run("return document.querySelectorAll('.legend')[2].innerText")
        a, b, supply = (float(own) for own in re.findall(r'\d+\.\d+', text))
        for shown, name in ((a, 'kfe.pressure_a'), (b, 'kfe.pressure_b'), (supply, (
                'supply.pressure'))):
            assert shown == pytest.approx(result[name][-1] * 1e-6, rel=5e-5)


def test_a_hostile_bag_runs_no_script(browser, tmp_path):
    """Markup in its name and in every text that a bag may have; it is shown as text."""
    own = Bag(GOLDEN / 'rotor_step')
    bag = rewrite(
        own, tmp_path / EVIL.replace('/', ''), versions={**own.provenance.versions, 'numpy': EVIL},
        configuration=lambda text: f'# {EVIL}\n' + re.sub(
            r'^source: .*$', f"source: '{EVIL}'\n{EVIL.split('=')[0]}: 1", text,
            flags=re.MULTILINE))
    with played(bag) as url:
        browser.visit(url)
        browser.wait("return document.getElementById('title').textContent !== ''")
        shown = browser.run('return document.body.innerText')
        assert 'onerror="window.hacked = 2">' in shown
        browser.run('order(arguments[0])', '<img src=x onerror=1>')     # is refused with its name
        browser.wait("return document.getElementById('note').textContent.includes('onerror')")
        assert browser.run('return window.hacked === undefined')
        assert browser.run("return document.querySelectorAll('img').length") == 0
        refused, = complaints(browser)
        assert '400 (Bad Request)' in refused


def test_the_policy_stops_markup_that_got_through(browser):
    """Neither a script, a handler, a style nor a picture from elsewhere; nor a frame around."""
    with played(GOLDEN / 'rotor_step') as url:
        browser.visit(url)
        browser.run("""
            document.querySelector('main').insertAdjacentHTML('beforebegin',
              '<img src="data:," onerror="window.hacked = 2"><style>main {opacity: 0}</style>');
            const own = document.body.appendChild(document.createElement('script'));
            own.textContent = 'window.hacked = 1'""")
        browser.wait('return document.body.dataset.frames > 3')
        assert browser.run('return window.hacked === undefined')
        assert browser.run(
            "return getComputedStyle(document.querySelector('main')).opacity") == '1'
        assert sum('Content Security Policy' in line for line in browser.log()) >= 3


def test_a_page_of_another_origin_cannot_order(browser):
    """Its POST fails, as it may neither read nor write."""
    with played(GOLDEN / 'leg_touchdown') as url, played(GOLDEN / 'rotor_step') as other:
        browser.visit(other)
        assert browser.run(
            "return fetch(arguments[0] + 'order', {method: 'POST', mode: 'no-cors',"
            "body: '{}'}).then(() => 'sent', error => error.name)", url) == 'TypeError'
        browser.log()


@contextmanager
def lived(out: Path, **more: object) -> Iterator[tuple[str, Callable[[], None]]]:
    """Run a rig meanwhile; yield the address of its page, and what waits for the run's end."""
    given = {'config': find('rig_linear', CONFIG), 'out': out, 'real_time_factor': 1.0, **more}
    session = prepare(Request(**given))
    told: 'Queue[str]' = Queue()
    ended = threading.Event()

    def run() -> None:
        with suppress(Interrupted):
            view_run(session, 0, Path(), told.put, None, ended.is_set)
    thread = threading.Thread(target=run)
    thread.start()
    try:
        yield told.get(timeout=120.0), thread.join
    finally:
        ended.set()
        thread.join()


def test_a_slider_changes_the_run_and_is_in_the_bag(browser, tmp_path):
    """By the field that the browser shows, at the tick that the page was told; it replays."""
    with lived(tmp_path / 'bag', duration_s=1.5, is_paused=True) as (url, join):
        browser.visit(url)
        browser.run("""
            window.told = [];
            const heard = new EventSource('frames');
            heard.onmessage = event => {
              window.told.push(...JSON.parse(event.data).answers);
              if (JSON.parse(event.data).is_over) heard.close();
            };
            return new Promise(done => { heard.onopen = () => done(1); })""")
        for _ in range(3):
            click(browser, 'step')
        browser.wait(f'{CLOCK} === 0.003')
        browser.run("""
            const own = document.querySelector('input[data-name=position]');
            own.value = 400;
            own.dispatchEvent(new Event('input'))""")
        browser.wait('return window.told.length === 4')
        shown = browser.run("return document.querySelector('aside label output').textContent")
        assert float(shown) == pytest.approx(40.0, abs=1e-9)    # 0.4 of a stroke of 100 mm
        assert browser.run("return document.getElementById('note').textContent") == (
            'ram: position = 0.04')
        answer = browser.run('return window.told[3]')
        assert answer['tick'] == 3
        browser.run("[...document.querySelectorAll('.fault')].find("
                    "own => own.textContent === 'valve stuck').click()")
        browser.wait("return document.querySelector('.fault.on') !== null")
        click(browser, 'pause')
        browser.wait("return document.getElementById('state').textContent === 'ended'")
        assert browser.run("return document.getElementById('pause').disabled")
        join()
        assert browser.log() == []
    result = isa_ros.read(tmp_path / 'bag')
    assert result.time[-1] == 1.5
    reference = result['ram.position_reference']
    assert reference[3] != reference[4] == reference[-1] == 0.04
    assert result.log.tuned[4][0] == {'plant.spool.stuck': 1.0}
    assert replay(Bag(tmp_path / 'bag')).is_equal


def test_a_page_that_is_closed_changes_nothing(browser, tmp_path):
    """The run goes on to its end, and its bag is that of a run without a page."""
    with lived(tmp_path / 'own' / 'bag', duration_s=0.8) as (url, join):
        browser.visit(url)
        browser.visit('about:blank', is_drawn=False)
        join()
    alone = isa_ros.load('rig_linear').simulate(0.8).save(tmp_path / 'alone' / 'bag')
    own, other = (next(path.glob('*.mcap')).read_bytes()
                  for path in (tmp_path / 'own' / 'bag', alone))
    assert own == other


def test_every_control_of_a_leg_is_there_and_the_chosen_actuator_has_its_own(browser, tmp_path):
    with lived(tmp_path / 'bag', is_paused=True, config=find('leg', CONFIG)) as (url, _):
        browser.visit(url)
        names = "return [...document.querySelectorAll('aside section input')].map("
        names += 'own => own.dataset.name)'
        rotary = browser.run(names)
        assert rotary[:4] == ['position', 'effort', 'stiffness', 'damping']
        assert 'reu.force.kp' in rotary
        choose(browser, 'source', 2)
        assert browser.run("return document.querySelector('aside h2').textContent") == (
            'kfe, mode impedance')
        assert 'reu.force.compensation.knee' in browser.run(names)
        choose(browser, 'source', 3)
        assert browser.run(names) == []
        assert browser.run("return document.querySelector('button.stop').textContent") == (
            'emergency stop')
        browser.resize(500, 900)
        browser.wait('return document.documentElement.scrollWidth <= innerWidth')
        browser.resize(1300, 900)
        assert browser.log() == []
