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


class Watching:
    """Notes what it is told."""

    def __init__(self, told: list[tuple[str, object]], name: str) -> None:
        self._told, self._name = told, name

    def start(self, kernel: object) -> None:
        """Note the kernel."""
        self._told.append((self._name, kernel))

    def end(self) -> None:
        """Note the end."""
        self._told.append((self._name, 'end'))


def test_who_watches_is_told_as_long_as_it_does() -> None:
    told: list[tuple[str, object]] = []
    own = Compilations()
    with own.watched_by(Watching(told, 'outer')):
        with own.watched_by(Watching(told, 'inner')):
            own.start('third')
        own.end()
    own.start('half')
    own.end()
    assert told == [('outer', 'third'), ('inner', 'third'), ('outer', 'end')]
