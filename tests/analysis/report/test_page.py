"""The page of a report in a browser: drawn, read to the sample, zoomed, and deaf to its bag."""

from pathlib import Path
import re

import isa_ros
from isa_ros.analysis.report.report import recorded, write_report
from isa_ros.analysis.signals.signals import read_signals
from isa_ros.bag.reader import Bag
from isa_ros.tick.trips import TripWarning
import pytest
from tests.analysis.report.test_events import FAULT, RIG
from tests.bag.golden import GOLDEN, rewrite

EVIL = '</script><script>window.hacked = 1</script><img src=x onerror="window.hacked = 2">'
TEXTS = "return [...document.querySelectorAll('.legend')].map(own => own.innerText)"


def page_of(bag: Path, folder: Path) -> Path:
    return write_report(recorded(bag), folder / 'page.html')[0]


@pytest.fixture(scope='module')
def tripped(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the bag of a run in which the load cell is implausible."""
    with pytest.warns(TripWarning):
        return RIG.simulate(faults=[FAULT]).save(tmp_path_factory.mktemp('page') / 'bag')


def test_every_panel_is_drawn_without_a_complaint(browser, tmp_path):
    """In large and small windows nothing is wider than the window."""
    bag = GOLDEN / 'leg_touchdown'
    browser.load(page_of(bag, tmp_path))
    assert browser.run("return document.querySelectorAll('.chart canvas').length") == 28
    for width in (1300, 500):
        browser.resize(width, 900)
        browser.wait('return [...document.querySelectorAll(".chart")].every('
                     'own => own.clientWidth < innerWidth)')
        assert browser.run('return document.documentElement.scrollWidth <= innerWidth')
    browser.resize(1300, 900)
    assert browser.log() == []


def test_a_run_of_one_sample_is_shown(browser, tmp_path):
    """And one of two; zooming into it does nothing wrong."""
    run = isa_ros.load('rig_linear').simulate(0.001).save(tmp_path / 'two')
    one = rewrite(Bag(run), tmp_path / 'one',
                  lambda topic, sequence, data: data if sequence == 0 else None)
    for bag, end in ((run, '0.0010'), (one, '0.0000')):
        browser.load(page_of(bag, tmp_path))
        browser.run("dispatchEvent(new KeyboardEvent('keydown', {key: '+'}))")
        assert browser.run("return document.getElementById('range').textContent") == (
            f'0.0000 to {end} s')
        assert browser.run("return document.querySelectorAll('.chart').length") == 7
    assert browser.log() == []


def test_the_canvas_has_the_curves(browser, tmp_path):
    """Pixels in the color of the first curve, from the left to the right end."""
    browser.load(page_of(GOLDEN / 'leg_touchdown', tmp_path))
    extent = browser.run("""
        const canvas = document.querySelector('#group-kfe canvas'), g = canvas.getContext('2d');
        const {data, width} = g.getImageData(0, 0, canvas.width, canvas.height), xs = [];
        for (let k = 0; k < data.length; k += 4)
          if (data[k] < 60 && data[k + 1] < 130 && data[k + 2] > 150 && data[k + 3] > 200)
            xs.push(k / 4 % width / width);
        return [Math.min(...xs), Math.max(...xs)]""")
    assert extent[0] < 0.1 and extent[1] > 0.95


def test_hovering_reads_the_exact_sample(browser, tmp_path):
    """Of all curves at the time of the cursor, in every panel; to 5 digits and half a step."""
    bag = GOLDEN / 'rotor_step'
    browser.load(page_of(bag, tmp_path))
    browser.run("document.querySelector('main').scrollIntoView()")
    browser.move('#group-rotor .u-over', 37, 0)
    browser.wait("return document.getElementById('cursor').textContent !== ''")
    t_s = float(re.findall('[0-9.]+', browser.run(
        "return document.getElementById('cursor').textContent"))[0])
    signals = read_signals(bag)
    k = int(abs(signals.time - t_s).argmin())
    assert 0.0 < t_s == pytest.approx(signals.time[k], abs=1e-9)
    texts = browser.run(TEXTS)
    for text, name, scale in ((texts[0], 'position', 57.29577951), (texts[2], 'force', 1.0)):
        measured, reference = (float(word) for word in re.findall(r'-?\d[0-9.e+-]*', text))
        for found, own in ((measured, name), (reference, f'{name}_reference')):
            values = signals[f'rotor.{own}'] * scale
            step = (values.max() - values.min()) / 65533
            assert found == pytest.approx(values[k], rel=5e-5, abs=step)


def test_a_drag_zooms_all_panels_and_a_key_shows_all_again(browser, tripped, tmp_path):
    browser.load(page_of(tripped, tmp_path))
    whole = browser.run("return document.getElementById('range').textContent")
    assert whole == '0.0000 to 0.2800 s'
    browser.run("document.querySelector('main').scrollIntoView()")
    browser.move('#group-ram .u-over', -100, 0, then_to=100)
    browser.wait(f"return document.getElementById('range').textContent !== '{whole}'")
    begin, end = (float(word) for word in re.findall('[0-9.]+', browser.run(
        "return document.getElementById('range').textContent")))
    width = browser.run("return document.querySelector('#group-ram .u-over').clientWidth")
    assert end - begin == pytest.approx(0.28 * 200 / width, rel=0.03)
    browser.run("dispatchEvent(new KeyboardEvent('keydown', {key: '0'}))")
    browser.wait(f"return document.getElementById('range').textContent === '{whole}'")
    assert browser.log() == []


def test_events_are_marked_and_lead_to_their_time(browser, tripped, tmp_path):
    """States as bands, and a click on a row of the table shows what happened there."""
    browser.load(page_of(tripped, tmp_path))
    states = browser.run("return [...document.querySelectorAll('.band')].map(e => e.textContent)")
    assert states == ['initialising', 'enabled', 'fault', 'enabled']
    marks = browser.run("return [...document.querySelectorAll('.mark')].map(e => e.className)")
    assert 'mark k-trip' in marks and 'mark k-change' in marks and 'mark k-warning' in marks
    trip, = (own for own in isa_ros.read(tripped).events if own.kind == 'trip')
    browser.run("[...document.querySelectorAll('tr[data-t]')].find("
                "row => row.innerText.includes('trip')).click()")
    browser.wait("return document.getElementById('range').textContent !== '0.0000 to 0.2800 s'")
    begin, end = (float(word) for word in re.findall('[0-9.]+', browser.run(
        "return document.getElementById('range').textContent")))
    assert begin == pytest.approx(trip.t_s - 0.05, abs=1e-4)
    assert end == pytest.approx(trip.t_s + 0.15, abs=1e-4)


def test_a_hostile_bag_runs_no_script(browser, tmp_path):
    """Markup in every text that a bag may have; it is shown as text."""
    own = Bag(GOLDEN / 'rotor_step')
    bag = rewrite(
        own, tmp_path / 'bag', versions={**own.provenance.versions, 'numpy': EVIL},
        configuration=lambda text: f'# {EVIL}\n' + re.sub(
            r'^source: .*$', f"source: '{EVIL}'", text, flags=re.MULTILINE))
    page = page_of(bag, tmp_path)
    browser.load(page)
    assert browser.run('return window.hacked === undefined')
    assert browser.run('return document.body.innerText').count('onerror="window.hacked = 2">') >= 2
    assert browser.log() == []


def test_the_policy_stops_markup_that_got_through(browser, tmp_path):
    """Neither a script, a handler, a style nor a picture from elsewhere."""
    page = page_of(GOLDEN / 'rotor_step', tmp_path)
    text = page.read_text()
    page.write_text(text.replace('<main>', (
        '<script>window.hacked = 1</script><img src="x:" onerror="window.hacked = 2">'
        '<style>main { display: none }</style><main>')))
    browser.load(page)
    assert browser.run('return window.hacked === undefined')
    shown = browser.run("return getComputedStyle(document.querySelector('main')).display")
    assert shown == 'block'
    assert sum('Content Security Policy' in line for line in browser.log()) >= 3


def test_thinning_keeps_peaks_and_gaps_and_the_nearest_sample_is_read(browser, tmp_path):
    """A spike of one sample up, one down and a gap among 100 000, drawn on 500 pixels."""
    browser.load(page_of(GOLDEN / 'rotor_step', tmp_path))
    assert browser.run("""
        const grid = gridOf([{t0: 0, step: 1e-3, n: 100000}], 0), v = new Float32Array(100000);
        v[777] = 9; v[40003] = -7; v[60000] = NaN;
        const [x, y] = thinned(grid, v, 0, 100, 500);
        return [x.length < 1010, y.includes(9), x[y.indexOf(9)], x[y.indexOf(-7)],
                y.filter(own => own === null).length, x[y.indexOf(null)]]""") == [
        True, True, pytest.approx(0.777), pytest.approx(40.003), 1, pytest.approx(60.0)]
    assert browser.run("""
        const at = gridOf([{t0: 2, step: 0.1, n: 50}], 0).at;
        return [at(2.24), at(2.26), at(0), at(99)]""") == [2, 3, 0, 49]
