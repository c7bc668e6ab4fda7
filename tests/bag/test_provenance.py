"""Provenance: a round trip through the bag, and every kind of missing part."""

from dataclasses import replace
import re
import sys

import isa_ros
from isa_ros.bag import provenance
from isa_ros.bag.provenance import installed_versions, Provenance
from isa_ros.bag.reader import Bag
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


def test_the_version_is_that_of_the_running_code(monkeypatch):
    """Not of the metadata of an installation, which an edit of a clone does not change."""
    monkeypatch.setattr(provenance, 'version', lambda name: '7.8.9')
    versions = installed_versions()
    assert versions.pop('isa_ros') == isa_ros.__version__ != '7.8.9'
    assert set(versions.values()) == {'7.8.9', versions['python']}


def test_bag_holds_nothing_of_the_host(tmp_path):
    """The only data of the host that the writer receives is the directory."""
    data = record(tmp_path / 'a_telling_name', 3).read_bytes()
    for text in ('a_telling_name', str(tmp_path)):
        assert text.encode() not in data, text


def test_a_lost_state_is_missed():
    """A run that went on from a saved state cannot be repeated from t = 0."""
    saved = replace(PROVENANCE, state='{}')
    assert read_back(saved.attachments(), saved.record()) == saved
    with pytest.raises(BagError, match='attachment state.json is missing'):
        read_back(PROVENANCE.attachments(), saved.record())


def test_an_altered_record_of_a_bag_cut_short_is_noticed(tmp_path):
    """Its checksum would be at the end of the file; rosbag2's record has a copy."""
    path = record(tmp_path / 'rig', 700)
    data = path.read_bytes()[:-100_000]
    assert data.count(b'version.numpy') == 2
    path.write_bytes(data.replace(b'version.numpy', b'version.numpz', 1))
    with pytest.raises(BagError, match='the records isa_ros and rosbag2 differ in provenance'):
        assert Bag(path).provenance
    path.write_bytes(data)
    assert Bag(path).provenance == PROVENANCE


def test_an_attachment_of_an_impossible_length_is_refused(tmp_path):
    """Its length does not fit into an index of Python."""
    path = record(tmp_path / 'rig', 3)
    name = b'configuration.yaml'
    data = path.read_bytes()
    at = data.index(name) + len(name) + len(b'application/yaml') + 4
    path.write_bytes(data[:at] + b'\xff' * 8 + data[at + 8:])
    with pytest.raises(BagError, match='malformed Attachment record'):
        Bag(path)
