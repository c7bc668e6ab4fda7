"""Lines: first resonance and damping of the distributed line, steady drop, walls, tears."""

import math

from isa_ros.config.text.parameter_sets import members
from isa_ros.surroundings.circuits.line import Wall
import numpy as np
import pytest
from tests.surroundings.circuits.sheets import Bench, sheet_of

RHO, NU, BETA = 860.0, 32e-6, 1.2e9
LENGTH, BORE = 2.0, 0.012
AREA = 0.25 * math.pi * BORE * BORE
SPEED = math.sqrt(BETA / RHO)
SIGMA = 16.0 * NU / (BORE * BORE)       # R'/(2 I') = 32 rho nu/(A d^2) / (2 rho/A)
SHUT = """
tank: {kind: tank}
pump: {kind: pump, inlet: tank, outlet: end, pressure_mpa: 20.0, displacement_ml: 1.0,
       speed_rpm: 0.0}
start: {kind: manifold, oil_volume_l: 1.0e-6}
end: {kind: manifold, oil_volume_l: 1.0e-6}
"""
LINE = 'line: {kind: line, inlet: %s, outlet: end, length_m: 2.0, bore_mm: 12.0, lumps: %d}\n'


def ringing(inlet: str, lumps: int, wave: float) -> tuple[float, float]:
    """Return frequency (rad/s) and decay (1/s) of the first mode, let go in its shape."""
    ends = SHUT if inlet == 'start' else SHUT.replace('start: {', '# {')
    bench = Bench(ends + LINE % (inlet, lumps))
    nodes = [bench.network.node(inlet), *bench.network.inner('line'), bench.network.node('end')]
    for k, node in enumerate(nodes):
        # end: the greatest pressure; 1 Pa: the flow is laminar
        shape = math.cos(wave * math.pi * (lumps - k) / lumps)
        bench.state[node] = bench.network.nodes[node]['c'] * shape
    period = 2.0 * math.pi / (SPEED * wave * math.pi / LENGTH)
    h = period / 2000.0
    pressures = [bench.pressure('end')]
    for _ in range(8000):
        bench.advance(1, h)
        pressures.append(bench.pressure('end'))
    p = np.array(pressures)
    falls = np.flatnonzero((p[:-1] > 0.0) & (p[1:] <= 0.0))
    crossings = (falls + p[falls] / (p[falls] - p[falls + 1])) * h
    omega = 2.0 * math.pi * (len(crossings) - 1) / (crossings[-1] - crossings[0])
    peaks = [p[k - 1000:k + 1000].max() for k in (2000, 4000, 6000)]
    decay = math.log(peaks[0] / peaks[2]) / (4000 * h)
    return omega, decay


@pytest.mark.parametrize(('inlet', 'wave'), [('tank', 0.5), ('start', 1.0)])
def test_a_line_rings_and_decays_as_the_distributed_one(inlet: str, wave: float) -> None:
    """Shut at one end a quarter wave, at both a half; friction R Q alone (C48), within 1 %."""
    omega, decay = ringing(inlet, 8, wave)
    free = wave * math.pi * SPEED / LENGTH
    assert omega == pytest.approx(math.sqrt(free * free - SIGMA * SIGMA), rel=0.01, abs=0.0)
    # the shape is not exactly that of the lumped mode, whose overtones decay alike
    assert decay == pytest.approx(SIGMA, rel=0.01, abs=0.0)


@pytest.mark.parametrize(('inlet', 'wave', 'lumps'), [
    ('tank', 0.5, 4), ('start', 1.0, 7)])
def test_so_few_lumps_are_within_a_percent(inlet: str, wave: float, lumps: int) -> None:
    """As docs/parts.md says; the low frequency is that of the header, (pi w/n)^2/24."""
    omega, _ = ringing(inlet, lumps, wave)
    free = wave * math.pi * SPEED / LENGTH
    expected = 1.0 - (math.pi * wave / lumps) ** 2 / 24.0
    assert omega / free == pytest.approx(expected, abs=5e-4)
    assert abs(omega / free - 1.0) < 0.01


def test_the_steady_drop_is_laminar_and_then_turbulent() -> None:
    """Hagen and Poiseuille's below Re = 1190, Blasius's above, of the whole line."""
    for flow, law in ((1e-5, 'laminar'), (1e-3, 'turbulent')):
        bench = Bench(SHUT.replace('start: {', '# {').replace(
            'kind: tank', 'kind: tank, pressure_mpa: 2.0') + LINE % ('tank', 4))
        bench.drawn[bench.network.node('end')] = flow
        bench.advance(400_000, 2e-5)
        v = flow / AREA
        reynolds = v * BORE / NU
        f = 64.0 / reynolds if law == 'laminar' else 0.3164 / reynolds ** 0.25
        expected = f * LENGTH / BORE * 0.5 * RHO * v * v
        assert 2e6 - bench.pressure('end') == pytest.approx(expected, rel=1e-6, abs=0.0)


def test_walls_soften_a_line_as_their_data_sheets_say() -> None:
    """C49: d/(E t) of a steel tube, e/P_e of a hose."""
    volume = AREA * LENGTH
    for wall, soft in (
            ('{kind: rigid}', 0.0), ('{kind: tube, thickness_mm: 1.5}', 12.0 / (2.06e11 * 1.5)),
            ('{kind: hose, expansion: 0.02, expansion_mpa: 10.0}', 0.02 / 10e6)):
        bench = Bench(SHUT + LINE.replace('}', f', wall: {wall}}}') % ('start', 8))
        total = sum(float(bench.network.nodes[k]['c']) for k in range(2, bench.n))
        assert total == pytest.approx(volume * (1.0 / BETA + soft) + 2e-9 / BETA,
                                      rel=1e-12, abs=0.0)


def test_a_burst_line_lets_its_oil_out() -> None:
    """An orifice of 0.62 times the opening, from the outlet to the outside."""
    bench = Bench(SHUT + LINE.replace('}', ', burst: 0.1}') % ('start', 4))
    for place in ('start', 'line', 'end'):
        bench.put(place, 5e6)
    element = bench.network.elements[bench.network.of('line')[-1]]
    assert float(element['orifice']['k']) == pytest.approx(
        0.62 * 0.1 * AREA * math.sqrt(2.0 / RHO), rel=1e-12, abs=0.0)
    bench.state[4 * bench.n + bench.network.of('line')[-1]] = 1.0
    before = bench.state[1:bench.n].sum()
    bench.advance(20_000, 1e-6)
    assert bench.pressure('end') < 1e6
    gone = before - bench.state[1:bench.n].sum()
    assert bench.state[0] == pytest.approx(gone, rel=1e-12, abs=0.0)


def test_a_line_to_the_tank_tears_before_it() -> None:
    """At the last node with a pressure of its own."""
    bench = Bench(SHUT.replace('start: {', '# {') + (LINE % ('end', 4)).replace(
        'outlet: end', 'outlet: tank'))
    tear = bench.network.elements[bench.network.of('line')[-1]]
    assert int(tear['inlet']) == bench.network.inner('line')[-1]
    assert int(tear['outlet']) == 0


def test_lumps_are_whole() -> None:
    with pytest.raises(Exception, match=r'parts\.line\.lumps = 2\.5, must be a whole number'):
        sheet_of(SHUT + 'line: {kind: line, inlet: start, outlet: end, length_m: 2.0, '
                 'bore_mm: 12.0, lumps: 2.5}\n')


def test_walls_have_the_kinds_that_files_say():
    assert list(members(Wall)) == ['rigid', 'tube', 'hose']
