"""Provenance: a round trip through the bag, and every kind of missing part."""

from dataclasses import replace
from importlib.metadata import PackageNotFoundError
from pathlib import Path
import re
import sys

from isa_ros.bag import provenance
from isa_ros.bag.provenance import installed_versions, Provenance
from isa_ros.errors import BagError
import numpy as np
import pytest
from tests.bag.recorded import PROVENANCE, record


def read_back(attachments, metadata):
    """Return the provenance of these records."""
    return Provenance.of_records(attachments, metadata, 'x.mcap')


def test_records_give_the_same_provenance_back():
    odd = replace(PROVENANCE, configuration='ä: "\n"\n', seed=-(2**70))
    assert read_back(odd.attachments(), odd.record()) == odd


@pytest.mark.parametrize('key, value, expected', [
    ('format', '2', "x.mcap: provenance format '2', must be '1'"),
    ('seed', 'one', "seed 'one', must be an integer"),
    ('scenario.yaml.sha256', '', 'attachment scenario.yaml does not match its sha256'),
])
def test_altered_record_is_refused(key, value, expected):
    with pytest.raises(BagError, match=expected):
        read_back(PROVENANCE.attachments(), PROVENANCE.record() | {key: value})


def test_altered_configuration_is_refused():
    attachments = PROVENANCE.attachments() | {'configuration.yaml': b'name: other\n'}
    with pytest.raises(BagError, match='configuration.yaml does not match its sha256'):
        read_back(attachments, PROVENANCE.record())


def test_versions_are_those_that_results_depend_on():
    versions = installed_versions()
    assert sorted(versions) == ['isa_ros', 'llvmlite', 'numba', 'numpy', 'python']
    assert versions['numpy'] == np.__version__
    assert versions['python'] == '{}.{}'.format(*sys.version_info)
    assert all(re.fullmatch(r'\d+\.\d+\S*', version) for version in versions.values())


def test_source_tree_declares_the_version_that_is_not_installed(monkeypatch):
    def missing(name):
        raise PackageNotFoundError(name)

    monkeypatch.setattr(provenance, '_RESULT_DEPENDS_ON', ())
    monkeypatch.setattr(provenance, 'version', missing)
    manifest = Path(provenance.__file__).parents[2] / 'package.xml'
    assert f'<version>{installed_versions()["isa_ros"]}</version>' in manifest.read_text()


def test_bag_holds_nothing_of_the_host(tmp_path):
    """The only data of the host that the writer receives is the directory."""
    data = record(tmp_path / 'a_telling_name', 3).read_bytes()
    for text in ('a_telling_name', str(tmp_path)):
        assert text.encode() not in data, text
