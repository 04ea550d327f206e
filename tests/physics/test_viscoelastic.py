"""Generalized Maxwell solids: Lee and Radok, a dense reference, and what holds for any number of branches."""

import pickle

import numpy as np
import pytest

import asperity as asp
from asperity.lattice import Lattice
from tests.surfaces import correlated

P = asp.protocols
THREE = [(0.3, 0.1), (0.25, 1.0), (0.35, 20.0)]
TWELVE = [(0.08, 10.0**decade) for decade in np.linspace(-3, 3, 12).tolist()]
SOLIDS = {"one": [(0.7, 1.0)], "three": THREE, "twelve": TWELVE}


def sphere(n):
    """A sphere whose summit is between sites, at no symmetric place."""
    x = np.arange(n) / n
    return -((x[:, None] - 0.5037) ** 2 + (x - 0.4859) ** 2) * n


def test_a_separable_solid_is_exact_over_thirty_decades():
    series = asp.relaxation.PronySeries(1.0, tuple((0.02, 10.0**decade) for decade in range(-2, 29)))
    solid = asp.solids.half_space(modulus=1.0, branches=series.branches)
    times = [1e-2, 1e10, 1e29]
    history = asp.age(asp.press(sphere(32), solid, load=20.0), times)
    for time, area in zip(times, history.dataset["area"].values[1:], strict=True):
        elastic = asp.press(
            sphere(32), asp.solids.half_space(modulus=1.0), load=20.0 * float(series.compliance_at(time))
        )
        assert area == pytest.approx(elastic.area, abs=1)


@pytest.mark.parametrize(("name", "path"), [("one", "constant"), ("three", "ramp"), ("twelve", "ramp")])
@pytest.mark.parametrize("exact", [True, False], ids=["exact", "march"])
def test_a_sphere_follows_lee_and_radok(name, exact, path):
    heights, branches = sphere(100), SOLIDS[name]
    solid = asp.solids.half_space(modulus=1.0, branches=branches)
    times = np.array([0.01, 0.1, 1.0, 10.0, 50.0])
    start, end = (100.0, 100.0) if path == "constant" else (30.0, 200.0)

    def load_at(time):
        return start + (end - start) * time / 50.0

    contact = asp.press(heights, solid, load=start)
    protocol = None if path == "constant" else P.Ramp(50.0, load=end)
    history = asp.age(contact, times, protocol=protocol, exact=exact)
    assert ("exact_contact" in history.dataset.attrs) == exact
    elastic, series = asp.solids.half_space(modulus=1.0), asp.relaxation.PronySeries(1.0, tuple(branches))
    loads = series.effective_load([0.0, *times], [start, *load_at(times)])[1:]
    areas = [asp.press(heights, elastic, load=load).area for load in loads]
    miss = history.dataset["area"].values[1:] - areas
    assert np.abs(miss).max() <= (1 if exact else 3)  # of 10,000


def rough(n=64):
    return correlated(n, hurst=0.8)


def test_the_exact_path_and_the_march_agree_on_all_fields():
    heights, times = rough(), np.array([0.05, 0.5, 5.0, 50.0])
    contact = asp.press(heights, asp.solids.half_space(modulus=1.0, branches=THREE), load=0.02 * heights.size)
    protocol = [P.Hold(5.0), P.Ramp(10.0, load=0.05 * heights.size), P.Hold(35.0)]
    one, other = (
        asp.age(contact, times, protocol=protocol, exact=exact, fields_at=times, rtol=1e-3).dataset
        for exact in (True, False)
    )
    assert one.attrs["exact_contact"] == "at all times"
    assert "exact_contact" not in other.attrs
    np.testing.assert_allclose(one["area"], other["area"], atol=2)
    spread = contact.u.std()
    for name in ("u", "u0"):
        miss = np.sqrt(((one[name] - other[name]) ** 2).mean(["x", "y"]))
        assert miss.max() < 1e-3 * spread
    np.testing.assert_allclose(one["load"], other["load"], rtol=1e-9)
    np.testing.assert_allclose(one["energy"], other["energy"], rtol=5e-4)
    np.testing.assert_allclose(one["separation"], other["separation"], atol=5e-4 * spread)


def test_after_the_load_has_fallen_contacts_are_exact_only_where_they_are_more_than_ever():
    # Sites that never touched do not know that others have: T. C. T. Ting, J. Appl. Mech. 35, 248 (1968).
    heights, size = rough(), 64**2
    contact = asp.press(heights, asp.solids.half_space(modulus=1.0, branches=THREE), load=0.03 * size)
    steps = [P.Step(load=load * size) for load in (0.015, 0.02, 0.06)]
    protocol = [P.Hold(2.0), *(leg for step in steps for leg in (step, P.Hold(2.0)))]
    frames: list[asp.Frame] = []
    one = asp.age(contact, [1.0, 8.0], protocol=protocol, progress=frames.append)
    exact = [frame.exact for frame in frames if not isinstance(protocol[frame.leg], P.Step)]
    assert exact == [False, True, True, False, False, True]  # at first nothing has crept
    most = np.maximum.accumulate([frame.contact.area for frame in frames])
    assert most[-1] > most[2] > frames[-3].contact.area
    assert one.dataset.attrs["exact_contact"] == "at some times"
    other = asp.age(contact, [1.0, 8.0], protocol=protocol, exact=False)
    np.testing.assert_allclose(one.dataset["area"], other.dataset["area"], atol=2)
    miss = one.final.pressure - other.final.pressure
    assert miss.std() < 2e-3 * one.final.pressure.std()
    u0, same = (state.final.u0 - state.final.u0.mean(axis=(1, 2), keepdims=True) for state in (one, other))
    assert (u0 - same).std() < 2e-3 * contact.u.std()


def test_aging_on_stays_exact():
    contact = asp.press(rough(), asp.solids.half_space(modulus=1.0, branches=THREE), load=100.0)
    once = asp.age(contact, [10.0], rtol=1e-4)  # so solvers leave some 1e-8 in u
    twice = asp.age(asp.age(contact, [1.0], rtol=1e-4).final, [9.0], rtol=1e-4)
    assert twice.dataset.attrs["exact_contact"] == "at all times"
    np.testing.assert_array_equal(twice.final.in_contact, once.final.in_contact)
    np.testing.assert_allclose(twice.final.u, once.final.u, atol=1e-7)


@pytest.mark.parametrize("exact", [True, False], ids=["exact", "march"])
def test_equal_branches_are_one_and_branches_of_hardly_a_share_are_none(exact):
    heights, protocol = rough(32), [P.Hold(2.0), P.Step(load=10.0), P.Hold(2.0)]
    finals = []
    for branches in (
        [(0.6, 1.5)],
        [(0.1, 1.5), (0.2, 1.5), (0.3, 1.5)],
        [(1e-13, 0.1), (0.6, 1.5), (1e-13, 100.0)],
    ):
        solid = asp.solids.half_space(modulus=1.0, branches=branches)
        contact = asp.press(heights, solid, load=30.0)
        finals.append(asp.age(contact, [4.0], protocol=protocol, exact=exact, rtol=5e-4).final)
    one, *others = finals
    for final, crept in zip(others, (slice(None), slice(1, 2)), strict=True):
        np.testing.assert_array_equal(final.in_contact, one.in_contact)
        assert (final.u - one.u).std() < 5e-4 * one.u.std()
        for anchor in final.anchors[crept] - one.anchors[0]:
            assert anchor.std() < 5e-4 * one.u.std()
        assert final.energy == pytest.approx(one.energy, rel=1e-3)


@pytest.mark.parametrize("exact", [True, False], ids=["exact", "march"])
def test_work_of_a_ramp_is_energy_and_dissipation(exact):
    heights = rough(16)
    contact = asp.press(heights, asp.solids.half_space(modulus=1.0, branches=THREE), load=5.0)
    times = np.concatenate([[0.0], np.geomspace(1e-3, 0.02, 20), np.linspace(0.03, 2.0, 198)])
    history = asp.age(
        contact, times, protocol=P.Ramp(2.0, load=40.0), fields_at=times, rtol=1e-3, exact=exact
    )
    data = history.dataset
    ny, nx = heights.shape
    q = 2 * np.pi * np.hypot(np.fft.fftfreq(ny)[:, None], np.fft.fftfreq(nx)[None, :])
    lost = np.zeros(len(times))
    for branch, (share, time) in enumerate(THREE):
        modes = np.fft.fft2((data["u"] - data["u0"].isel(branch=branch)).values)
        lost += np.sum(share * q / 2 * np.abs(modes) ** 2, axis=(1, 2)) / heights.size / time
    load, approach, energy = (data[name].values for name in ("load", "approach", "energy"))
    worked = np.sum((load[1:] + load[:-1]) / 2 * np.diff(approach))
    dissipated = np.sum((lost[1:] + lost[:-1]) / 2 * np.diff(times))
    assert dissipated > 0.1 * worked
    assert worked == pytest.approx(energy[-1] - energy[0] + dissipated, rel=5e-4)


@pytest.mark.parametrize("apparatus", [None, np.inf])
def test_one_site_has_no_waves_and_keeps_its_load(apparatus):
    solid = asp.solids.half_space(modulus=1.0, branches=THREE, apparatus=apparatus)
    final = asp.age(asp.press([1.0], solid, load=2.0), [1.0, 10.0]).final
    assert final.area == 1
    assert final.load == pytest.approx(2.0)


@pytest.mark.parametrize(("branches", "exact"), [([(0.7, 1.0)], False), (TWELVE, True)])
def test_a_history_takes_few_iterations_and_keeps_its_areas(branches, exact):
    # 22 for each contact problem when guesses lost contacts to rounding, and stages were solved to 1e-6.
    contact = asp.press(rough(), asp.solids.half_space(modulus=1.0, branches=branches), load=100.0)
    times = np.geomspace(1e-2, 1e2, 6)
    usual, strict = (asp.age(contact, times, exact=exact, rtol=rtol).dataset for rtol in (2e-3, 2e-4))
    problems = int((usual["steps"] + usual["rejected"]).sum()) * (1 if exact else 2)
    assert int(usual["iterations"][1:].sum()) < 9 * problems
    assert float(usual["residual"][1:].max()) < 1e-13
    np.testing.assert_allclose(usual["area"], strict["area"], rtol=5e-3, atol=1)


@pytest.mark.parametrize("exact", [True, False], ids=["exact", "march"])
def test_the_energy_is_that_of_the_published_fields(exact):
    lattice = Lattice((64, 64))
    contact = asp.press(rough(), asp.solids.half_space(modulus=1.0, branches=TWELVE), load=100.0)
    final = asp.age(contact, [1.0, 10.0], exact=exact).final
    stiffness, permanent = lattice.wave_number / 2, 1.0 - sum(share for share, _ in TWELVE)
    parts = [
        (permanent, final.u),
        *((g, final.u - v) for (g, _), v in zip(TWELVE, final.anchors, strict=True)),
    ]
    energy = sum(share * np.sum(field * lattice.apply(stiffness, field)) / 2 for share, field in parts)
    assert final.energy == pytest.approx(energy, rel=1e-11)


def aged(*, exact=False, edges="periodic", apparatus=None):
    branches = [(0.3, 0.1), (0.5, 2.0)]
    solid = asp.solids.half_space(modulus=1.0, branches=branches, apparatus=apparatus)
    contact = asp.press(asp.surfaces.Surface(correlated(32), edges=edges), solid, load=20.0)
    return asp.age(contact, [1.0], exact=exact, hold="separation" if apparatus else None).final


@pytest.mark.parametrize("way", [{}, {"exact": True}, {"edges": "reflecting"}, {"apparatus": 30.0}])
def test_branches_asked_for_late_are_in_equilibrium_with_the_surface(way):
    contact = aged(**way)
    system = contact.system()
    u, stretch = contact.u - system.datum, contact.u - contact.anchors
    force = system.mechanics.force(u, stretch, system.held(contact.separation - system.datum))
    assert np.abs(force[~contact.in_contact]).max() <= 1e-8 * contact.residual_scale
    np.testing.assert_allclose(force[contact.in_contact], contact.force[contact.in_contact], rtol=1e-7)
    assert contact.anchors is contact.anchors
    assert not contact.anchors.flags.writeable


def test_branches_nobody_asked_for_survive_a_pickle():
    contact = aged()
    again = pickle.loads(pickle.dumps(contact))
    np.testing.assert_array_equal(again.anchors, aged().anchors)
    assert not again.anchors.flags.writeable
