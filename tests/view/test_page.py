"""The page in a browser: a bag plays, and its curves have the values of the bag."""

import re

import isa_ros
import pytest
from tests.bag.golden import GOLDEN
from tests.view.pages import choose, click, CLOCK, played


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
