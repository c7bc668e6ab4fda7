"""Tests that run at once, in two workers or two suites, never share a ROS domain."""

import os
import subprocess
import sys

import pytest
from tests.ros.domains import held_domain, observing, refuse_used

pytestmark = pytest.mark.ros
HOLD_ANOTHER = """
import pytest
from tests.ros.domains import held_domain
with pytest.MonkeyPatch.context() as patch, held_domain(patch) as domain:
    print(domain)
"""


def test_another_process_holds_another_domain(domain):
    done = subprocess.run(
        [sys.executable, '-c', HOLD_ANOTHER], check=True, capture_output=True, text=True)
    assert int(done.stdout) != domain


def test_a_domain_is_free_again_after_the_test(monkeypatch):
    with held_domain(monkeypatch) as first, held_domain(monkeypatch) as second:
        assert first != second and os.environ['ROS_DOMAIN_ID'] == str(second)
    with held_domain(monkeypatch) as third:
        assert third == first


def test_a_domain_in_which_a_node_is_left_is_used(domain, monkeypatch):
    with observing(monkeypatch), pytest.raises(OSError, match='in use'):
        refuse_used(domain)
    refuse_used(domain)
