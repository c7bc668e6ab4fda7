"""What waits for the first compilation is called once, and only while it waits."""

from isa_ros.core.compilations import Compilations, compilations


def test_what_waits_is_called_once_the_last_first() -> None:
    called: list[str] = []
    own = Compilations()
    with own.awaited_by(lambda: called.append('outer')), \
            own.awaited_by(lambda: called.append('inner')):
        assert called == []
        own.begin()
        own.begin()
    assert called == ['inner', 'outer']


def test_what_has_waited_in_vain_is_not_called() -> None:
    """Also where the context ends with an error; another that waits stays."""
    called: list[str] = []
    own = Compilations()
    with own.awaited_by(lambda: called.append('stays')):
        try:
            with own.awaited_by(lambda: called.append('gone')):
                raise KeyError
        except KeyError:
            own.begin()
    assert called == ['stays']


def test_a_process_has_one() -> None:
    assert compilations() is compilations()
