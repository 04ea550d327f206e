"""A half-space pressed in SI, beside Tamaas and ContactMechanics where they are installed.

`benchmarks/agreement.py` compares whole scans, and the aging; see docs/validation.md.
"""

import importlib
import sys
from pathlib import Path

import numpy as np
import pytest

BENCHMARKS = Path(__file__).parents[2] / "benchmarks"


@pytest.fixture
def agreement(monkeypatch):
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    before = set(sys.modules)
    yield importlib.import_module("agreement")
    for name in set(sys.modules) - before:
        if str(BENCHMARKS) in str(getattr(sys.modules[name], "__file__", "")):
            del sys.modules[name]


@pytest.fixture
def peer(agreement, request):
    solvers = importlib.import_module("solvers")
    try:
        worker = solvers.start(request.param, solvers.interpreters([]), 1)
    except solvers.SolverError as error:
        pytest.skip(f"{request.param} is absent (benchmarks/peers/install): {error}")
    yield worker
    worker.close()


@pytest.mark.parametrize("peer", ["tamaas", "contactmechanics"], indirect=True)
@pytest.mark.parametrize("spacing", [(1.0, 1.0), (1.0, 1.7)])
def test_press_agrees_with_peers_on_square_and_oblong_pixels(agreement, peer, spacing, tmp_path):
    surface = agreement.generated(64, spacing)
    ours = agreement.press(surface, 2e6, strict=True)
    problem = agreement.problem_of(surface, 2e6)
    _, theirs, difference, residual = agreement.closest(peer, problem, ours, tmp_path, [1e-12])
    assert 0.05 < theirs.fraction < 0.5
    assert residual < 1e-9
    assert difference.beyond(agreement.LIMITS) == []


@pytest.mark.parametrize("peer", ["tamaas-maxwell"], indirect=True)
def test_maxwell_march_of_tamaas_tends_to_ours_as_its_step_does_to_zero(agreement, peer, tmp_path):
    asp = agreement.asp
    surface, share, tau, end = agreement.generated(32), 0.8, 2.0, 1.0
    solid = asp.solids.half_space(modulus=agreement.MODULUS, branches=[(share, tau)])
    final = asp.age(asp.press(surface, solid, pressure=1e6), [end], rtol=1e-4).final
    law = agreement.Law("half-space", modulus=agreement.MODULUS, branches=[(share, tau)])
    problem = agreement.problem_of(surface, 1e6, law)
    path, out = tmp_path / "problem.npz", tmp_path / "answer.npz"
    agreement.running.write(problem, path)
    pressures = []
    for step in (1 / 8, 1 / 16):
        options = {"step": step, "tolerance": 1e-10}
        request = {"do": "age", "problem": str(path), "times": [end], "out": str(out), "options": options}
        assert max(peer.ask(request, 60)["gap_in_contact"]) < 1e-8
        with np.load(out) as answer:
            pressures.append(answer["force"][0] / problem.cell)
    errors = [np.linalg.norm(p - final.pressure) / np.linalg.norm(final.pressure) for p in pressures]
    assert errors[0] / errors[1] == pytest.approx(2, abs=0.15)
    extrapolated = 2 * pressures[1] - pressures[0]
    assert np.linalg.norm(extrapolated - final.pressure) < 2e-3 * np.linalg.norm(final.pressure)


def test_a_difference_is_seen(agreement):
    """By its size, in the quantity that has it; what is not a number is beyond every limit."""
    pressure, gap = np.array([[2.0, 1.0], [0.0, 1.0]]), np.array([[0.0, 0.0], [3.0, 0.0]])
    ours = agreement.State(pressure, gap, 0.5)
    assert agreement.compare(ours, ours).beyond(agreement.LIMITS) == []
    moved = agreement.State(pressure + [[1e-3], [0]] * pressure, gap + np.array([[0, 0], [1e-3, 0]]), 0.5)
    moved.pressure[1, 0] = 1e-3
    found = agreement.compare(ours, moved)
    assert found.sites == 1
    assert found.pressure == pytest.approx(1e-3)
    assert found.mean_pressure == pytest.approx(1e-3)
    assert found.gap == pytest.approx(2e-3)
    assert found.mean_gap == pytest.approx(5e-4)
    assert set(found.beyond(agreement.LIMITS)) == set(agreement.LIMITS)
    lost = agreement.State(pressure * np.nan, gap, 0.5)
    assert "pressure" in agreement.compare(ours, lost).beyond(agreement.LIMITS)
