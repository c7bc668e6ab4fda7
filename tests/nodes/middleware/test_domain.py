"""One coordinator per domain; on one host a second one is refused at once."""

import os
import socket
import subprocess
import sys
from types import SimpleNamespace

from isa_ros.errors import ConfigError
from isa_ros.nodes.middleware import domain
from isa_ros.nodes.middleware.domain import (
    Claim, claim_address, CLAIMED_BY, holder, look_for_other_coordinator, sole_coordinator)
from isa_ros.processes.domain_id import domain_id
import pytest
from tests.ros.domains import held_domain

OTHER_USER = 54321


def test_a_second_coordinator_is_refused(monkeypatch):
    with held_domain(monkeypatch) as number:
        with sole_coordinator():
            with pytest.raises(
                    ConfigError, match=f'another coordinator runs in ROS_DOMAIN_ID {number}'):
                with sole_coordinator():
                    pass
        with sole_coordinator():
            pass


def test_each_namespace_of_a_domain_has_one(monkeypatch):
    with held_domain(monkeypatch) as number, sole_coordinator(), sole_coordinator('left'):
        with pytest.raises(ConfigError, match=f'ROS_DOMAIN_ID {number}, namespace /left, must be'):
            Claim('/left/')
        with sole_coordinator('right'), sole_coordinator('left/arm'), sole_coordinator('a' * 250):
            pass


def test_a_coordinator_takes_the_name_that_its_launch_holds(monkeypatch):
    """And releases nothing: the launch holds it until the run has ended."""
    with held_domain(monkeypatch) as number, sole_coordinator('left'):
        monkeypatch.setenv(CLAIMED_BY, str(os.getpid()))
        with sole_coordinator('left'):
            pass
        assert holder(number, 'left').process == os.getpid()
        monkeypatch.setenv(CLAIMED_BY, str(os.getppid()))
        with pytest.raises(ConfigError, match='must be the only one'):
            Claim('left')


def test_another_domain_is_free(monkeypatch):
    with held_domain(monkeypatch), sole_coordinator():
        with held_domain(monkeypatch), sole_coordinator():
            pass


@pytest.mark.parametrize(('text', 'number'), [(None, 0), ('', 0), ('0', 0), ('232', 232)])
def test_domain_of_the_environment(monkeypatch, text, number):
    monkeypatch.delenv('ROS_DOMAIN_ID', raising=False)
    if text is not None:
        monkeypatch.setenv('ROS_DOMAIN_ID', text)
    assert domain_id() == number


@pytest.mark.parametrize('text', ['-1', '233', 'leg', '1.5'])
def test_no_domain_is_refused(monkeypatch, text):
    monkeypatch.setenv('ROS_DOMAIN_ID', text)
    with pytest.raises(ConfigError, match='must be an integer from 0 to 232'):
        domain_id()


@pytest.mark.parametrize('listens', [False, True])
def test_a_name_that_another_user_holds_proves_nothing(monkeypatch, listens):
    """The run begins; what decides is the graph, for which it waits."""
    with held_domain(monkeypatch) as number, \
            socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as squatter:
        squatter.bind(claim_address(number))
        if listens:  # as this user; the kernel names another one only to another one
            squatter.listen()
            monkeypatch.setattr(os, 'geteuid', lambda: OTHER_USER)
        with sole_coordinator():
            assert holder(number) is None or holder(number).user != os.geteuid()


def test_the_graph_decides_where_the_name_is_held_by_another_user(monkeypatch):
    """With discovery on this host only."""
    waited = []
    monkeypatch.setattr(domain, 'refuse_other_coordinator', waited.append)
    monkeypatch.setattr(domain, 'DISCOVERY_S', 0.1)
    here = {'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST'}
    with held_domain(monkeypatch) as number, sole_coordinator():
        node = SimpleNamespace(
            context=SimpleNamespace(get_domain_id=lambda: number), get_namespace=lambda: '/')
        look_for_other_coordinator(node, here)
        assert len(waited) == 1
        monkeypatch.setattr(os, 'geteuid', lambda: OTHER_USER)
        look_for_other_coordinator(node, here)
        assert len(waited) > 2


@pytest.mark.skipif(os.geteuid() != 0, reason='only root becomes another user')
def test_the_kernel_names_the_user_that_listens(monkeypatch):
    with held_domain(monkeypatch) as number:
        program = (
            'import os, socket, sys\n'
            f'os.setuid({OTHER_USER})\n'
            's = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)\n'
            f's.bind({claim_address(number)!r})\n'
            's.listen()\nprint(flush=True)\nsys.stdin.read()\n')
        with subprocess.Popen([sys.executable, '-c', program], stdin=subprocess.PIPE,
                              stdout=subprocess.PIPE) as squatter:
            squatter.stdout.readline()
            assert holder(number).user == OTHER_USER
            with sole_coordinator():
                pass
            squatter.stdin.close()


def test_of_actuators_alone_with_one_name_the_second_is_refused(monkeypatch):
    """Both would publish on the same topics; in another namespace it is another actuator."""
    with held_domain(monkeypatch) as number:
        first, other = Claim('/', 'knee'), Claim('/left', 'knee')
        with pytest.raises(ConfigError, match=f'^/left/knee: another actuator .* {number}; end'):
            Claim('/left', 'knee')
        with pytest.raises(ConfigError, match='^/knee: another actuator of this name runs alone'):
            Claim('/', 'knee')
        with sole_coordinator():
            first.close()
            Claim('/', 'knee').close()
        other.close()
