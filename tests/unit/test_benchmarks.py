"""The benchmarks' own judges and tables, without any peer."""

import ast
import importlib
import json
import sys
from pathlib import Path

import numpy as np
import pytest

import asperity as asp
from asperity.contact import remarks

BENCHMARKS = Path(__file__).parents[2] / "benchmarks"


@pytest.fixture
def house(monkeypatch):
    """Import a module of the benchmarks, which are scripts beside each other rather than a package."""
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    before = set(sys.modules)
    yield importlib.import_module
    for name in set(sys.modules) - before:
        if str(BENCHMARKS) in str(getattr(sys.modules[name], "__file__", "")):
            del sys.modules[name]


def plane_wave(shape, i, j):
    x, y = np.meshgrid(*map(np.arange, shape), indexing="ij")
    return np.cos(2 * np.pi * (i * x / shape[0] + j * y / shape[1]) + 0.3)


def make_problem(house, kind, heights, **law):
    problem = house("peers.problem")
    return problem.Problem(heights, problem.Law(kind, **law), 0.05 * heights.size)


def test_the_judge_and_peers_multiply_a_plane_wave_by_the_stiffness_of_the_law(house):
    check = house("check")
    shape, i, j = (24, 20), 3, 7
    wave, noise = plane_wave(shape, i, j), np.random.default_rng(3).normal(size=shape)
    qx, qy = 2 * np.pi * i / shape[0], 2 * np.pi * j / shape[1]
    lam = 4 - 2 * np.cos(qx) - 2 * np.cos(qy)
    for kind, law, stiffness in (
        ("lattice", {"k1": 0.3}, lam + 0.3),
        ("relaxed", {"k1": 0.3}, lam),
        ("half-space", {"modulus": 2.5}, 2.5 * np.hypot(qx, qy) / 2),
        ("step", {"k1": 3.0, "R": 2.0, "tau": 0.7}, lam + 3.0 / (1 + 0.7 * 3.0 * 2.0 * lam)),
    ):
        problem = make_problem(house, kind, np.zeros(shape), **law)
        assert check.force_of(problem, wave) == pytest.approx(stiffness * wave + 0.05, abs=1e-13), kind
        given = np.fft.irfft2(problem.stiffness() * np.fft.rfft2(noise), s=shape)  # to the peers
        assert check.force_of(problem, noise) == pytest.approx(given + 0.05, abs=1e-12), kind


def test_a_wrong_memory_is_noticed(house, monkeypatch):
    check = house("check")
    step = make_problem(house, "step", np.zeros((8, 8)), k1=1.0, tau=1.0)
    monkeypatch.setattr(check, "minus_laplacian", lambda u: 5 * u)
    with pytest.raises(ArithmeticError, match=r"the step's equation is off by"):
        check.step_memory(plane_wave((8, 8), 1, 2), step.law)


@pytest.mark.parametrize("verb", ["press", "relax"])
def test_the_judge_accepts_asperity_and_nothing_else(house, verb):
    check = house("check")
    heights = house("synthetic").white(48)
    problem = make_problem(house, "lattice" if verb == "press" else "relaxed", heights, k1=0.3)
    contact = asp.press(heights, asp.solids.spring_lattice(k0=1.0, k1=0.3), load=problem.load)
    if verb == "relax":
        contact = asp.relax(contact)
    true = check.judge(problem, contact.u + 5.0, contact.in_contact)
    assert (true.residual < 1e-8, true.load_error < 1e-10, true.penetration < 1e-12) == (True, True, True)
    assert true.contact_fraction == contact.area / heights.size

    missing = contact.in_contact.copy()
    missing[tuple(np.argwhere(missing)[0])] = False
    assert check.judge(problem, contact.u, missing).residual > 1e-3
    lowered = contact.u - 0.1 * (~contact.in_contact)
    worse = check.judge(problem, lowered, contact.in_contact)
    assert worse.residual > 1e-3
    assert worse.penetration > 0
    assert check.judge(problem, contact.u, np.zeros_like(missing)).residual == np.inf


def test_a_step_without_memory_is_the_step(house):
    """What peers are given, solved for u - v, leaves u with the force H u + C D (u - u0)."""
    prepare, check = house("prepare"), house("check")
    rng = np.random.default_rng(1)
    heights, u0, w = (rng.normal(size=(16, 16)) for _ in range(3))
    own = make_problem(house, "lattice", heights, k1=0.8)
    given = prepare.step(own, u0, np.zeros_like(u0))
    u = w + (heights - given.heights)
    law = given.law
    creep = check.step_memory(u - u0 - (u - u0).mean(), law)
    force = law.k0 * check.minus_laplacian(u) + law.k1 * creep + own.mean_force
    assert check.force_of(given, w) == pytest.approx(force, abs=1e-12)


def test_self_affine_heights_have_the_spectrum_they_are_said_to_have(house):
    heights = house("synthetic").self_affine(256)
    assert heights.std() == pytest.approx(1.0)
    assert abs(heights.mean()) < 1e-12
    power = np.abs(np.fft.rfft2(heights)) ** 2
    q = np.hypot(np.fft.fftfreq(256)[:, None], np.fft.rfftfreq(256)) * 256
    bands = [power[(q >= low) & (q < 1.2 * low)].mean() for low in (16, 80)]
    # 2 (1 + H) decades of power a decade of q; each band averages over hundreds of modes.
    assert np.log(bands[0] / bands[1]) / np.log(5) == pytest.approx(3.6, abs=0.15)
    assert power[(q > 0) & (q < 8)].mean() == pytest.approx(power[(q > 6) & (q < 8)].mean(), rel=0.3)


def row(solver, seconds, residual=1e-9, **more):
    numbers = {"contact_fraction": 0.05, "iterations": 12, "sites_that_differ": 0, "failure": ""}
    clock = {"seconds": seconds, "best_seconds": seconds, "cpu_seconds": seconds, "residual": residual}
    return {"case": "a", "solver": solver, **numbers, **clock, **more}


def test_speed_is_measured_by_the_fastest_peer_that_is_accurate(house, tmp_path):
    report = house("report")
    book = report.Book(house("machine").facts(), threads=1, target=1e-8)
    book.absent["tamaas"] = "no interpreter has it"
    book.rows += [
        row("asperity", 0.1),
        row("numpi", 2.0, iterations=-1),
        row("slippy", 0.5, residual=1e-5),
        {"case": "a", "solver": "petsc", "failure": "over 9 s"},
        row("slippy", 0.01, case="b"),
    ]
    book.save(tmp_path)
    stored = json.loads((tmp_path / "table.json").read_text())
    assert [entry["speed"] for entry in stored["rows"]] == [20.0, 1.0, 4.0, None, 1.0]
    page = (tmp_path / "table.md").read_text()
    assert "| a | 1 | asperity | 5.00 % | 12 | 1.0e-09 | 0 | 0.1 | 0.1 | 20 |" in page
    assert "| a | 1 | numpi | 5.00 % | ? |" in page
    assert "1.0e-05!" in page
    assert "over 9 s" in page
    assert "tamaas is absent: no interpreter has it" in page
    assert "tamaas is absent" in book.text()
    busy = row("asperity", 1.0, cpu_seconds=0.5)  # is marked where it had less than its threads
    assert ["1*" in report.cells(busy, [busy], threads, 1e-8) for threads in (1, 2)] == [True, False]


def test_a_missing_peer_is_said_and_not_fatal(house):
    solvers = house("solvers")
    pythons = [sys.executable, "/nowhere/python"]
    assert "/nowhere/python" not in solvers.interpreters(pythons)
    with pytest.raises(solvers.SolverError, match=r"No module named 'tamaas'"):
        solvers.start("tamaas", [sys.executable], 1)
    with pytest.raises(solvers.SolverError, match=r"no interpreter to look in \(--peers-python\)"):
        solvers.start("tamaas", [], 1)


@pytest.mark.slow
def test_asperity_answers_through_its_worker(house, tmp_path):
    """The whole way: files, process, public interface, judge; and an error is a reply, not an end."""
    solvers, prepare, check = house("solvers"), house("prepare"), house("check")
    problem = make_problem(house, "lattice", house("synthetic").white(32), k1=1.0)
    path, out = tmp_path / "problem.npz", tmp_path / "answer.npz"
    prepare.write(problem, path)
    worker = solvers.start(solvers.ASPERITY, [], 1)
    try:
        with pytest.raises(solvers.SolverError, match="FileNotFoundError"):
            worker.ask({"do": "solve", "problem": str(tmp_path / "no"), "tolerance": 0.0}, 60)
        request = {"do": "solve", "problem": str(path), "tolerance": 0.0, "out": str(out)}
        reply = worker.ask(request, 60)
        assert reply["seconds"] > 0
        with np.load(out) as fields:
            assert check.judge(problem, fields["u"], fields["in_contact"]).residual < 1e-8
        aged = worker.ask({"do": "age", "problem": str(path), "times": [0.0, 0.1]}, 60)
        assert aged["steps"] > 0
        with pytest.raises(solvers.SolverError, match="over 0 s"):
            worker.ask(request, 0.0)
        assert worker.ask(request, 60)["iterations"] == reply["iterations"]
    finally:
        worker.close()


def test_tolerances_tighten_by_half_decades(house, monkeypatch, tmp_path):
    tolerances = house("tolerances")
    monkeypatch.setattr(tolerances, "STORED", tmp_path / "tolerances.json")
    assert tolerances.known("numpi", "a") == tolerances.LOOSEST
    tolerances.keep("a", {"numpi": 1e-6})
    tolerances.keep("b", {"numpi": 1e-9})
    assert tolerances.known("numpi", "b") == 1e-9
    assert tolerances.known("numpi", "c") == 1e-6
    assert [tolerances.tighter(one) for one in (1e-6, 3.2e-7, 2e-15)] == [3.2e-7, 1e-7, None]


def test_every_tuned_number_of_contacts_is_seen(house):
    """Fractions stand in a `Tuning`, which sensitivity.py finds, but for those that rounding sets.

    Those of remarks say when to speak, and change no answer.
    """
    seen = {module.__file__ for module, *_ in house("sensitivity").tunings()}
    for path in {*(Path(asp.__file__).parent / "contact").rglob("*.py")} - {Path(remarks.__file__)}:
        tree = ast.parse(path.read_text())
        classes = [
            node for node in ast.walk(tree) if isinstance(node, ast.ClassDef) and node.name == "Tuning"
        ]
        assert not classes or str(path) in seen, path
        tuned = {number for one in classes for number in ast.walk(one)}
        numbers = [node for node in ast.walk(tree) if isinstance(node, ast.Constant) and node not in tuned]
        left = [node.value for node in numbers if isinstance(node.value, float)]
        assert not [x for x in left if 1e-5 < abs(x) < 1e5 and 2 * x != round(2 * x)], path
