"""Contacts that stick: Maugis' ball, Johnson's wavy line, energies of cycles, and histories with jumps."""

import math
import tomllib
from dataclasses import dataclass
from typing import Annotated, Any, cast

import numpy as np
import pytest
from annotated_types import Gt

import asperity as asp
from asperity.analysis.rows import history_rows
from asperity.app.config import to_toml
from asperity.app.config.python import to_python
from asperity.app.config.reading import config_from
from asperity.base.parameters import Quantity
from asperity.contact import ActiveSet
from asperity.errors import PulledOff, Remark
from asperity.results import load_contact
from asperity.results.checkpoint import Keeper
from asperity.solids import Dugdale, coated_half_space, half_space, layer
from asperity.surfaces import Surface
from tests.dense_reference import Dense
from tests.physics.test_dense_reference import maxwell
from tests.refusals import each_refuses, refuses

P = asp.protocols
RADIUS = 400.0


def ball(shape, places=((0.0, 0.0),)):
    y, x = (np.arange(n) - (n - 1) / 2 for n in shape)
    return np.max([-((y[:, None] - b) ** 2 + (x - a) ** 2) / (2 * RADIUS) for b, a in places], axis=0)


def sticking(lam, unit, **how):
    """A half-space with Maugis' lambda on a ball, its unit of radius in pixels, and the unit of loads."""
    K = 4 / 3
    w = unit**3 * K / (math.pi * RADIUS**2)
    s0 = lam / 2 * (math.pi * w * K**2 / RADIUS) ** (1 / 3)
    solid = half_space(modulus=1.0, adhesion=Dugdale(work=w, range=w / s0), **how)
    return solid, math.pi * w * RADIUS


def maugis(lam):
    """Load and radius of D. Maugis, in their units, with the largest tension first."""
    m = 1 + np.logspace(-6, 4, 4000)
    s, sec = np.sqrt(m**2 - 1), np.arccos(1 / m)
    A, B = lam / 2 * (s + (m**2 - 2) * sec), 4 * lam**2 / 3 * (s * sec - m + 1)
    a = (np.sqrt(B**2 + 4 * A) - B) / (2 * A)
    load = a**3 - lam * a**2 * (s + m**2 * sec)
    stable = a >= a[load.argmin()]
    order = load[stable].argsort()
    return load[stable][order], a[stable][order]


def judged(contact):
    """Forces of Dugdale's law: at least -s0 in contact, that within the range, 0 beyond."""
    law, cell = contact.solid.adhesion, contact.lattice.cell
    pull, apart = law.strength * cell, ~contact.in_contact
    within = apart & (contact.gap < law.range)
    assert contact.force.min() >= -pull * (1 + 1e-12)
    np.testing.assert_array_equal(contact.force[within], -pull)
    np.testing.assert_array_equal(contact.force[apart & ~within], 0.0)
    assert contact.residual <= 1e-8
    return contact


def radius(contact):
    return math.sqrt(contact.contact_area_corrected / math.pi)


@pytest.mark.parametrize(
    ("lam", "unit", "size", "loads"),
    [
        (0.5, 12.0, 64, [1.0, 0.0, -1.0]),
        pytest.param(0.1, 16.0, 128, [1.0, 0.0, -1.0, -1.5], marks=pytest.mark.slow),
        pytest.param(0.3, 20.0, 112, [1.0, 0.0, -1.0, -1.5], marks=pytest.mark.slow),
        pytest.param(0.5, 24.0, 128, [1.0, 0.0, -1.0, -1.5], marks=pytest.mark.slow),
        pytest.param(1.0, 44.0, 192, [1.0, 0.0, -1.0, -1.3], marks=pytest.mark.slow),
    ],
)
def test_a_ball_is_that_of_maugis(lam, unit, size, loads):
    solid, one = sticking(lam, unit)
    known, contact = maugis(lam), None
    for load in loads:
        rough = Surface(ball((size, size)), edges="free")
        contact = (
            asp.press(rough, solid, load=load * one)
            if contact is None
            else asp.press(contact, load=load * one)
        )
        judged(contact)
        assert contact.load == pytest.approx(load * one, abs=1e-9 * one)
        assert radius(contact) == pytest.approx(np.interp(load, *known) * unit, rel=0.02)


@pytest.mark.parametrize(
    ("lam", "unit", "size", "through", "error"),
    [
        (0.1, 6.0, 48, "load", 0.02),
        pytest.param(0.3, 16.0, 80, "load", 0.02, marks=pytest.mark.slow),
        pytest.param(0.3, 16.0, 80, "separation", 0.02, marks=pytest.mark.slow),
        pytest.param(0.5, 20.0, 112, "load", 0.02, marks=pytest.mark.slow),
        pytest.param(1.0, 40.0, 176, "load", 0.025, marks=pytest.mark.slow),  # 30 pixels in the zone
    ],
)
def test_it_is_pulled_off_under_the_load_of_maugis(lam, unit, size, through, error):
    solid, one = sticking(lam, unit)
    contact = asp.press(Surface(ball((size, size)), edges="free"), solid, load=0.0)
    pulled = asp.pull(contact, through=through)
    assert pulled.force / one == pytest.approx(-maugis(lam)[0][0], rel=error)
    if through == "separation":
        return
    with pytest.raises(PulledOff) as off:
        asp.press(pulled.last, load=-1.05 * pulled.force)
    assert off.value.load == pytest.approx(pulled.last.load)
    with pytest.raises(PulledOff):
        asp.press(Surface(ball((size, size)), edges="free"), solid, load=-3 * one)


def test_a_long_range_pulls_as_on_rigid_bodies():
    solid, one = sticking(0.02, 6.0)
    contact = asp.press(Surface(ball((96, 96)), edges="free"), solid, load=-1.9 * one)
    assert contact.area > 0  # B. V. Derjaguin, V. M. Muller, Yu. P. Toporov: up to 2 pi w R
    with pytest.raises(PulledOff):
        asp.press(contact, load=-2.02 * one)


class Rounds:
    """A solver that does not know of adhesion, so that contacts are solved for one attraction at a time."""

    def solve(self, problem, guess, accuracy):
        assert problem.interface.adhesion is None
        return ActiveSet().solve(problem, guess, accuracy)


@pytest.mark.parametrize(
    "seed", [2, *(pytest.param(n, marks=pytest.mark.slow) for n in (0, 1, *range(3, 8)))]
)
def test_attraction_revised_with_the_contacts_leads_to_states_of_no_more_energy(seed):
    draw = np.random.default_rng(seed)
    kind = {"hurst": draw.uniform(0.5, 1), "cutoff": draw.choice([8.0, 16.0]), "roll_off": 32.0}
    rough = asp.surfaces.spectral((80, 80), rms_height=draw.uniform(0.3, 1.5), seed=seed, **kind)
    length = draw.uniform(0.05, 0.4)
    law = Dugdale(work=math.pi * length**2 / 4 / draw.uniform(7, 30), range=length)
    solid, pressure = half_space(modulus=1.0, adhesion=law), 10 ** draw.uniform(-4, -2)
    rounds = contact = asp.press(rough, solid, pressure=pressure, solver=Rounds())
    for part in (None, 4.0, 1.0, 0.25, 2.0):  # approach, retreat and approach again
        if part is None:
            contact = asp.press(rough, solid, pressure=pressure)
        else:
            contact = asp.press(rounds, pressure=part * pressure)
            rounds = asp.press(rounds, pressure=part * pressure, solver=Rounds())
        judged(contact)
        within, reference = (one.gap < law.range for one in (contact, rounds))
        assert (within != reference).mean() < 0.01
        if (within != reference).any():  # fronts that pixels pin have gone a pixel further
            energy, most = (one.energy + one.load * one.u.mean() for one in (contact, rounds))
            assert energy < most + 1e-9 * abs(most)
        else:
            assert np.array_equal(contact.in_contact, rounds.in_contact)
            np.testing.assert_allclose(contact.u, rounds.u, rtol=0, atol=1e-7 * law.range)


@pytest.mark.parametrize(
    ("n", "zone", "alpha", "top"),
    [
        (2048, 24, 0.3, 0.1),
        pytest.param(8192, 48, 0.3, 0.1, marks=pytest.mark.slow),
        pytest.param(8192, 48, 0.5, 0.03, marks=pytest.mark.slow),
    ],
)
def test_a_wavy_line_is_that_of_johnson(n, zone, alpha, top):
    height = n / 100
    w = (alpha * math.pi / math.sqrt(2) * height / n) ** 2 * n
    strength = math.sqrt(math.pi * w / (4 * zone))
    heights = -2 * height * np.sin(math.pi * (np.arange(n) / n - 0.5)) ** 2
    solid = half_space(modulus=1.0, adhesion=Dugdale(work=w, range=w / strength))
    angle = np.linspace(0.01, 1.5, 2000)
    pressure = np.sin(angle) ** 2 - alpha * np.sqrt(np.tan(angle))
    stable = slice(pressure[: pressure.argmax()].argmin(), pressure.argmax())
    known = 2 / math.pi * np.interp(0.5 * top, pressure[stable], angle[stable])
    unit, found = math.pi * height, []  # E* h / L on L
    contact = asp.press(heights, solid, load=0.0)
    for load in (0.5 * top, top, 0.5 * top):
        contact = asp.press(contact, load=load * unit)
        found.append(contact.contact_fraction)
    assert found[0] < found[2]  # pixels hold fronts back, forth and back, by a part of 1 / zone
    assert (found[0] + found[2]) / 2 == pytest.approx(known, rel=0.03 if n > 2048 else 0.05)
    assert found[0] > (0.96 if n > 2048 else 0.93) * known


def rough(edges, sites=24, seed=3):
    """A rough contact on which forces go up and down like a saw."""
    shape, roll_off = (sites, sites), sites / 2
    heights = asp.surfaces.spectral(
        shape, hurst=0.8, roll_off=roll_off, cutoff=6.0, seed=seed, rms_slope=0.12
    )
    apparatus = None if edges == "free" else math.inf
    solid = half_space(modulus=1.0, adhesion=Dugdale(work=0.004, range=0.2), apparatus=apparatus)
    return asp.press(Surface(heights, edges=edges), solid, load=1.0)


def followed(contact, places):
    """The same contact, and where it is held one after the other."""
    states = [contact]
    for place in places:
        states.append(asp.press(states[-1], separation=place))
    return states


@pytest.mark.slow
def test_the_pull_off_force_is_that_of_many_more_states():
    contact = rough("free")
    pulled = asp.pull(contact, steps=3)
    peak = float(pulled.curve["separation"].values[pulled.curve["load"].values.argmin()])
    fine = followed(contact, np.linspace(contact.separation, peak - 0.01, 30))
    sampled = -min(state.load for state in followed(fine[-1], np.linspace(peak - 0.01, peak + 0.01, 60)))
    assert (1 - 2e-3) * pulled.force <= sampled <= (1 + 1e-3) * pulled.force
    by_load = asp.pull(contact, through="load", steps=3)
    assert by_load.force == pytest.approx(pulled.force, rel=1e-3)
    with pytest.raises(PulledOff):
        asp.press(by_load.last, load=-1.0015 * by_load.force)


@pytest.mark.slow
@pytest.mark.parametrize("edges", ["free", "periodic"])
def test_the_energy_lost_is_that_of_many_more_states(edges):
    contact = rough(edges)
    pulled, coarse = asp.pull(contact), asp.pull(contact, steps=5)
    assert coarse.force == pytest.approx(pulled.force, rel=1e-3)
    assert coarse.energy_lost == pytest.approx(pulled.energy_lost, rel=0.01)
    places = np.linspace(contact.separation, float(pulled.curve["separation"].max()), 600)
    states = followed(contact, [*places[1:], *places[-2::-1]])
    loads = [state.load for state in states]
    assert loads[599] == 0
    lost = np.trapezoid(loads, -np.array([state.separation for state in states]))
    assert pulled.energy_lost == pytest.approx(lost, rel=0.01)


SEVEN = [("free", 1), ("free", 2), ("free", 4), ("periodic", 5), ("periodic", 7), ("reflecting", 6)]
SEVEN += [("reflecting", 8)]


@pytest.mark.slow
@pytest.mark.parametrize(("edges", "seed"), SEVEN)
def test_force_and_energy_hardly_depend_on_the_steps(edges, seed):
    """Where edges are not free, sites that change together would lift others."""
    contact = rough(edges, 16, seed)
    coarse, fine = (asp.pull(contact, steps=steps) for steps in (5, 40))
    assert coarse.force == pytest.approx(fine.force, rel=1e-3)
    assert coarse.energy_lost == pytest.approx(fine.energy_lost, rel=1e-2)


@pytest.mark.parametrize("edges", ["free", pytest.param("periodic", marks=pytest.mark.slow)])
def test_a_cycle_loses_the_area_of_its_loop(edges):
    solid, one = sticking(0.5, 2.5, **({} if edges == "free" else {"apparatus": math.inf}))
    contact = asp.press(Surface(ball((16, 16)), edges=edges), solid, load=0.5 * one)
    pulled = asp.pull(contact)
    load, approach, energy = (pulled.curve[name].values for name in ("load", "approach", "energy"))
    work = (load[1:] + load[:-1]) / 2 * np.diff(approach)
    lost = work - np.diff(energy)
    assert lost.min() > -0.03 * pulled.energy_lost  # as accurate as the trapezoids
    assert pulled.energy_lost == pytest.approx(lost.sum(), rel=1e-6)
    assert pulled.energy_lost > 0
    assert load[0] == load[-1] == 0.0
    assert pulled.last.area > 0
    assert pulled.force == pytest.approx(-load.min(), rel=1e-12)
    with refuses("energy_lost", "one through the load"):
        _ = asp.pull(contact, through="load", steps=4).energy_lost


class Sticky(Dense):
    """Dense matrices with Dugdale's traction on the sites whose gap was last within the range."""

    def stick(self, pull, reach):
        self.pull, self.reach, self.within = pull, reach, np.zeros(self.n, dtype=bool)
        return self

    def contact(self, v, load=None, position=None, known=0.0):
        while True:
            y, X, r = super().contact(v, load, position, known - self.pull * self.within)
            within = y + X - self.heights < self.reach
            if (within == self.within).all():
                return y, X, r
            self.within = within


@pytest.mark.parametrize(
    ("shape", "load"), [((64,), 0.0), ((64,), -0.3), pytest.param((16, 16), -0.05, marks=pytest.mark.slow)]
)
def test_a_viscoelastic_ball_ages_as_dense_matrices_let_it(shape, load):
    branches = [(0.5, 1.0)]
    squares = np.add.reduce(np.meshgrid(*((np.arange(n) - n / 2) ** 2 for n in shape), indexing="ij"))
    heights, law = -squares / 200.0, Dugdale(work=0.02, range=0.4)
    contact = asp.press(heights, half_space(modulus=1.0, branches=branches, adhesion=law), load=load)
    times = [0.25, 0.5, 1.0, 2.0]
    history = asp.age(contact, times, rtol=1e-4, fields_at=times)
    solid = *maxwell(lambda q, _: q / 2, branches), (1.0,) * len(shape)
    dense = Sticky.of_laws(heights, *solid).stick(0.05, 0.4)
    dense.within = (contact.gap < 0.4).ravel()
    v, step = np.zeros((1, heights.size)), 0.005

    def speed(v):
        y, _, _ = dense.contact(v, load=load)
        return dense.rate[0] @ (y - v[0])

    for number, time in enumerate(np.arange(1, 401) * step, start=1):
        middle = v + step / 2 * speed(v)
        v = v + step * speed(middle)
        if round(time, 9) in times:
            y, X, r = dense.contact(v, load=load)
            at = history.dataset.sel(field_time=round(time, 9), method="nearest")
            assert abs(int(at["in_contact"].sum()) - dense.touching.sum()) <= 1, number
            np.testing.assert_allclose(at["u"].values.ravel(), y + X, atol=3e-3 * np.ptp(y))
            assert (r - dense.pull * dense.within).sum() == pytest.approx(load, abs=1e-9)
    assert history["area"][-1] != history["area"][0]


def test_time_steps_pass_a_jump_into_contact():
    solid, _ = sticking(1.0, 12.0, branches=[(0.5, 1.0)])
    start = asp.press(Surface(ball((64, 64)), edges="free"), solid, separation=2.0)
    assert (start.area, start.load) == (0, 0.0)
    times = np.linspace(0.05, 1.5, 30)
    history = asp.age(start, times, protocol=P.Ramp(1.5, separation=-0.2), fields_at=times)
    area, load = history["area"].values, history["load"].values
    jump = int(np.diff(area).argmax())
    assert area[jump] == 0
    assert area[jump + 1] > 100
    assert load[jump] == 0.0
    assert load[jump + 1] < 0
    assert history["rejected"].values.sum() < 40
    assert history.dataset.attrs.get("exact_contact") is None
    judged(history.final)


@pytest.mark.parametrize("edges", ["periodic", "reflecting", "free"])
@pytest.mark.parametrize("solid", ["half-space", "layer", "film", "flow"])
def test_every_history_ends_in_states_that_are_judged(solid, edges):
    law, branches = Dugdale(work=0.01, range=0.3), [(0.5, 1.0)]
    if edges == "free" and solid != "half-space":
        pytest.skip("edges are free on half-spaces alone")
    made = {
        "half-space": lambda: half_space(modulus=1.0, branches=branches, adhesion=law, apparatus=math.inf),
        "layer": lambda: layer(modulus=1.0, poisson=0.3, thickness=20.0, branches=branches, adhesion=law),
        "film": lambda: coated_half_space(
            modulus=1.0,
            poisson=0.3,
            thickness=8.0,
            base_modulus=2.0,
            base_poisson=0.3,
            base_branches=branches,
            apparatus=math.inf,
            adhesion=law,
        ),
        "flow": lambda: half_space(modulus=1.0, flow=(0.1, 0), adhesion=law, apparatus=math.inf),
    }[solid]()
    x = 2 * np.pi * np.arange(32) / 32
    heights = 0.8 * np.cos(x)[:, None] * np.cos(x) + 0.3 * np.sin(2 * x)
    contact = judged(asp.press(Surface(heights, edges=edges), made, load=-1.0))
    assert contact.load == pytest.approx(-1.0)
    legs = [P.Hold(0.5), P.Ramp(0.5, load=-2.0), P.Step(load=1.0), P.Hold(0.5, hold="separation")]
    history = asp.age(contact, [1.0], protocol=legs)
    assert history["load"].values[:3] == pytest.approx([-1.0, -1.0, -2.0])
    assert history["load"].values[3] == pytest.approx(1.0)
    judged(history.final)
    again = judged(asp.press(history.final, load=0.0))
    assert again.load == pytest.approx(0.0, abs=1e-9)
    if solid != "flow":
        assert judged(asp.relax(again, hold="load")).load == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize(
    ("legs", "when"),
    [([P.Ramp(2.0, load=-5.0)], (0.1, 1.9)), ([P.Hold(0.5), P.Step(load=-5.0), P.Hold(1.0)], (0.5, 0.5))],
)
def test_a_record_ends_where_bodies_part(legs, when, tmp_path):
    solid, one = sticking(0.5, 6.0, branches=[(0.5, 1.0)])
    contact = asp.press(Surface(ball((40, 40)), edges="free"), solid, load=one)
    with pytest.warns(Remark, match="pulled off"):
        history = asp.age(contact, [0.05, 1.5], protocol=legs)
    parted = history.dataset.attrs["pulled_off"]
    assert when[0] <= parted <= when[1]
    assert history.time.values[-1] == parted
    assert judged(history.final).area > 0
    assert history["load"].values[-1] == pytest.approx(history.final.load)
    rows = asp.analysis.leg_table(history.dataset)
    assert (len(rows), rows[-1].end) == (1, parted)
    tension = {row.name: row.value for row in history_rows(history.dataset, None)}.get("largest tension")
    assert tension == (pytest.approx(-history.final.load) if history.final.load < 0 else None)
    history.save(tmp_path / "parted")
    history.final.save(tmp_path / "last")
    again = load_contact(tmp_path / "last", solid)
    np.testing.assert_array_equal(again.in_contact, history.final.in_contact)
    assert again.load == pytest.approx(history.final.load, rel=1e-6)


@pytest.mark.slow
def test_a_run_killed_before_bodies_part_goes_on_to_the_same_end(tmp_path, monkeypatch):
    solid, one = sticking(0.5, 6.0, branches=[(0.5, 1.0)])
    contact = asp.press(Surface(ball((40, 40)), edges="free"), solid, load=one)
    write = Keeper.write

    def aged(**how):
        with pytest.warns(Remark, match="pulled off"):
            return asp.age(contact, [0.05, 1.5], protocol=P.Ramp(2.0, load=-5.0), **how)

    whole = aged()
    steps = int(whole["steps"].values.sum())
    for last in (steps - 10, steps):
        written = iter(range(1, last))

        def killed(keeper, *kept, left=written):
            write(keeper, *kept)
            if next(left, None) is None:
                raise InterruptedError

        checkpoint = asp.Checkpoint(tmp_path / f"{last}.npz", every=0.0)
        monkeypatch.setattr(Keeper, "write", killed)
        with pytest.raises(InterruptedError):
            asp.age(contact, [0.05, 1.5], protocol=P.Ramp(2.0, load=-5.0), checkpoint=checkpoint)
        monkeypatch.setattr(Keeper, "write", write)
        resumed = aged(checkpoint=checkpoint)
        np.testing.assert_array_equal(resumed.time, whole.time)
        np.testing.assert_array_equal(resumed.final.u, whole.final.u)


@pytest.mark.parametrize("edges", ["periodic", "free"])
@pytest.mark.parametrize("left", [1e-9, 1e-11, 1e-13, 1e-14, 0.0])
def test_contacts_bear_what_all_sites_attract_to_the_last_digits(edges, left):
    x = 2 * np.pi * np.arange(16) / 16
    heights = 0.05 * (np.cos(x)[:, None] * np.cos(x) + 0.5 * np.sin(2 * x + 1))
    law = Dugdale(work=3.3, range=8.1)  # far longer than the heights: every site is within it
    contact = asp.press(Surface(heights, edges=edges), half_space(modulus=1.0, adhesion=law), load=1.0)
    all_attract = law.strength * heights.size
    if left < 1e-13:  # as much as the rounding of so many forces
        with pytest.raises(PulledOff):
            asp.press(contact, load=-(1 - left) * all_attract)
        return
    last = judged(asp.press(contact, load=-(1 - left) * all_attract))
    assert last.area > 0
    assert last.load == pytest.approx(-(1 - left) * all_attract, rel=1e-14)
    np.testing.assert_array_equal(last.force[~last.in_contact], -law.strength)


def test_a_contact_remembers_from_where_it_came():
    solid, _ = sticking(1.0, 12.0)
    far = asp.press(Surface(ball((64, 64)), edges="free"), solid, separation=2.0)
    near = asp.press(far, separation=-0.5)
    place = 1.03 * solid.adhesion.range
    forth, back = asp.press(far, separation=place), asp.press(near, separation=place)
    assert forth.area == 0
    assert back.area > 0
    assert back.load < forth.load == 0.0


@pytest.mark.parametrize("held", ["load", "separation"])
def test_a_first_press_with_free_edges_is_the_approach(held):
    """No site that pulls lifts another, so the sequence from no attraction ends at the first equilibrium."""
    solid = half_space(modulus=1.0, adhesion=asp.solids.Dugdale(work=0.1, range=1.0))
    for seed in range(2):
        heights = asp.surfaces.spectral((32, 32), roll_off=16, cutoff=6, rms_height=1.0, seed=seed)
        rough = Surface(heights, edges="free")
        top = float(heights.max())
        steps = np.linspace(1, 40, 14) if held == "load" else np.linspace(top + 2, top - 1.5, 14)
        contact = asp.press(rough, solid, **{held: steps[0]})
        for step in steps[1:]:
            contact = asp.press(contact, **{held: step})
        at_once = asp.press(rough, solid, **{held: steps[-1]})
        attracted = np.count_nonzero(contact.gap < 1)
        assert attracted > contact.area > 20
        np.testing.assert_array_equal(at_once.gap < 1, contact.gap < 1)
        assert at_once.load == pytest.approx(contact.load, rel=1e-7)


@dataclass(frozen=True)
class Fading(asp.solids.Adhesion):
    """A law of somebody's own: the traction falls like an exponential of the gap."""

    work: Annotated[float, Gt(0), Quantity("work of adhesion", "J/m^2", "w")]
    length: Annotated[float, Gt(0), Quantity("length", "m", "l")]

    @property
    def strength(self):
        return self.work / self.length

    def energy(self, gap):
        return -self.work * np.exp(-np.maximum(gap, 0.0) / self.length)

    def traction(self, gap):
        return self.strength * np.exp(-np.maximum(gap, 0.0) / self.length)


def test_another_law_of_the_gap_is_a_class():
    solid = half_space(modulus=1.0, branches=[(0.5, 1.0)], adhesion=Fading(0.02, 0.4))
    assert solid.parameters["adhesion_length"] == 0.4
    contact = asp.press(Surface(ball((32, 32)), edges="free"), solid, load=0.2)
    final = asp.age(contact, [1.0]).final
    for state in (contact, final):
        apart = ~state.in_contact
        np.testing.assert_allclose(state.force[apart], -solid.adhesion.traction(state.gap[apart]), rtol=1e-6)
        assert state.load == pytest.approx(0.2)


def test_what_cannot_stick_is_refused():
    law, heights = Dugdale(work=0.02, range=0.4), ball((16, 16))
    dugdale, short = (cast(Any, one) for one in ("dugdale", Dugdale(work=0.02, range=0.2)))
    scan = Surface(heights, unit="um", pixel_size=(1.0, 1.0), length_unit="um")
    rigid, eyring = half_space(modulus=1e6, adhesion=law), asp.solids.Eyring(rate=1.0, stress=1.0)
    contact = asp.press(heights, half_space(modulus=1.0, adhesion=law), load=1.0)
    plain = asp.press(heights, half_space(modulus=1.0), load=1.0)
    in_pa = asp.press(scan, half_space(modulus="1 MPa", adhesion=Dugdale("50 mJ/m^2", "1 um")), load="50 uN")

    def solid(adhesion, **how):
        return half_space(modulus=1.0, adhesion=adhesion, **how)

    each_refuses(
        ("adhesion", "a local law of creep", lambda: solid(law, creep=eyring)),
        ("adhesion", "a hardness", lambda: solid(law, hardness=1.0)),
        (
            *("adhesion", "a solid that is defined on sites"),
            lambda: asp.solids.Solid(springs=asp.solids.Springs(1.0, 3.0, 3.0, 0.0), adhesion=law),
        ),
        ("adhesion", "str", solid, dugdale),
        # A zone of pi / 4 0.02 / 1e-2 of 1.6.
        ("adhesion", "1", lambda: asp.press(heights, solid(short), load=1.0)),
        ("hold", "'area'", lambda: asp.age(contact, [1.0], hold="area")),
        ("separation", "a solid without either", lambda: asp.pull(contact, through="separation")),
        *(
            ("load", lambda leg=leg: asp.age(plain, [0.5], protocol=[leg, P.Hold(1.0)]))
            for leg in (P.Step(load=-1.0), P.Ramp(1.0, pressure=-1.0), P.Step(load=0.0))
        ),
        ("load", "-1", lambda: asp.press(heights, half_space(modulus=1.0), load=-1.0)),
        ("contact", "a solid without adhesion", asp.pull, plain),
        ("through", "'dugdale'", lambda: asp.pull(contact, through=dugdale)),
        ("material", "one with adhesion", lambda: asp.predict(rigid, scan, pressure=1e3)),
        ("solid", "one with adhesion", lambda: asp.law(rigid, scan, pressures=[1e3])),
        ("partial_slip", "adhesion", lambda: in_pa.partial_slip(shear="1 uN", friction=0.5)),
        ("units", "'50 mJ/m^2'", lambda: asp.press(heights, solid(Dugdale("50 mJ/m^2", 1.0)), load=1.0)),
    )
    with refuses("pull_off", "one with adhesion", advice="asperity.pull(contact)"):
        in_pa.pull_off(work="50 mJ/m^2")


def test_keys_of_a_file_are_the_law():
    keys = {"adhesion": "dugdale", "adhesion_work": "50 mJ/m^2", "adhesion_range": "10 nm"}
    solid = {"kind": "half_space", "young": "5 MPa", "poisson": 0.5, **keys}
    config = config_from({"solid": solid, "contact": {"load": "-1 nN"}}, {}, None)
    assert config.solid.build().adhesion == Dugdale(work=0.05, range=1e-8)
    written = to_python(config, [1.0])
    assert "adhesion=asp.solids.Dugdale(work=0.05, range=1e-08)" in written
    assert "asp.press(rough, solid, load=-1e-09)" in written
    assert config_from(tomllib.loads(to_toml(config)), {}, None).solid.build() == config.solid.build()
