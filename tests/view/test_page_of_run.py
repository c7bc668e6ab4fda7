"""The page of a run: what is moved on it changes the run, and is in the bag."""

import isa_ros
from isa_ros.bag.reader import Bag
from isa_ros.config.paths import CONFIG, find
from isa_ros.replay.replay import replay
import pytest
from tests.view.pages import choose, click, CLOCK, lived


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


def test_sliders_show_what_is_in_force(browser, tmp_path):
    """The force that the actuator took over, and the number of another page; not a moved one."""
    with lived(tmp_path / 'bag', is_paused=True, config=find('leg', CONFIG)) as (url, _):
        browser.visit(url)
        choose(browser, 'source', 2)
        value = ("const own = document.querySelector('input[data-name=effort]');"
                 "return parseFloat(own.parentElement.querySelector('output').textContent)")
        assert browser.run(value) == 0.0
        for _ in range(3):
            click(browser, 'step')
        browser.wait(f'{CLOCK} === 0.003')
        browser.wait(value.replace('return ', 'return Math.abs(') + ') > 20')
        knob = browser.run("return +document.querySelector('input[data-name=effort]').value")
        browser.run("order('setpoint', { of: 'kfe', name: 'effort', value: -1000 })")
        browser.wait(f'{value} === -1000')
        assert browser.run(
            "return +document.querySelector('input[data-name=effort]').value") < knob
        browser.run("""
            const own = document.querySelector('input[data-name=effort]');
            own.value = 1000;
            own.dispatchEvent(new Event('input'))""")
        browser.wait("return document.getElementById('note').textContent.startsWith("
                     "'kfe: effort = ')")
        assert browser.run(value) > 5000.0
        assert browser.log() == []


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
