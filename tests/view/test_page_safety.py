"""No markup of a bag becomes script, and no other page gives orders."""

import re

from isa_ros.bag.reader import Bag
from tests.bag.golden import GOLDEN, rewrite
from tests.browser import Browser
from tests.view.pages import played

EVIL = '<script>window.hacked = 1<script><img src=x onerror="window.hacked = 2">'


def complaints(browser: Browser) -> list[str]:
    """Return the messages of the console, less those about how a test reads pixels."""
    return [line for line in browser.log() if 'getImageData' not in line]


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
