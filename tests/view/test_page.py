"""The page in a browser: a bag plays, moves its machine, and no markup of it becomes script."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
import re
import threading

import isa_ros
from isa_ros.bag.reader import Bag
from isa_ros.scripting.result import Result
from isa_ros.view.playing import Player
from isa_ros.view.server import serving
import pytest
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
            assert browser.run('return document.documentElement.scrollWidth <= innerWidth')
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
        assert browser.run('return window.hacked === undefined')
        assert browser.run("return document.querySelectorAll('img').length") == 0
        assert complaints(browser) == []


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
