"""Records of indenters: what is read, what is inferred, and what is refused."""

from typing import Any

import numpy as np
import pytest

import asperity as asp
from asperity.inference import Indentation, read_indentation
from tests.refusals import each_refuses, refuses

TRUE = {"modulus": 1333.0, "share_1": 0.4, "time_1": 0.2}
SERIES = asp.relaxation.PronySeries(TRUE["modulus"], ((TRUE["share_1"], TRUE["time_1"]),))
RADIUS = 1e-5
TIME = np.linspace(0, 4, 161)
DEPTH = np.interp(TIME, (0, 0.8, 1.6, 3, 3.8, 4), (-1e-6, 0, 1e-6, 1e-6, -0.5e-6, -0.75e-6))
FORCE = asp.theory.ting(TIME, DEPTH, SERIES, RADIUS)
BALL = {"model": "ball", "radius": "10 um"}


def inferred(*data, **how) -> Any:
    return asp.infer(*data, **how)


def noisy(seed, rho=0.0, part=0.01, force=FORCE):
    random = np.random.default_rng(seed)
    errors: list[float] = []
    for white in random.standard_normal(force.size):
        errors.append(rho * errors[-1] + np.sqrt(1 - rho**2) * white if errors else white)
    return force + part * force.max() * np.array(errors)


@pytest.mark.parametrize(("contact", "signs"), [(0.0, (1, 1)), ("fit", (-1, -1))])
def test_a_record_gives_its_solid_and_retraction(contact, signs):
    found = inferred(
        TIME, signs[0] * DEPTH, force=signs[1] * noisy(1, part=1e-4), contact=contact, branches=1, **BALL
    )
    for name, value in TRUE.items():
        assert found.verdicts[name].value == pytest.approx(value, rel=0.01)
        assert found.verdicts[name].verdict == "determined"
    assert found.deviation[0] < 2e-3
    assert not any("drift" in remark or "misses" in remark for remark in found.remarks)
    assert [name for name, *_ in found.record.segments] == ["approach", "hold", "retraction"]
    words = "falls into the body, forces below 0" if signs[0] < 0 else "grows into the body, forces above 0"
    assert words in found.record.signs
    first, last = found.record.span
    assert (first, last) == pytest.approx((0.08, 2.2), abs=0.11)
    at = np.array([0.1, 1.0])
    np.testing.assert_allclose(found.modulus_at(at)[1], SERIES.modulus_at(at), rtol=0.01)


def test_cones_and_youngs_modulus():
    force = asp.theory.ting(TIME, DEPTH, SERIES, tip="cone", angle="70 deg")
    found = inferred(
        TIME, DEPTH, force=noisy(2, part=1e-4, force=force), model="cone", angle=70, poisson=0.5, branches=1
    )
    solid = found.solid()
    assert float(str(solid["young"]).split()[0]) == pytest.approx(0.75 * TRUE["modulus"], rel=0.01)
    assert (solid["kind"], solid["poisson"]) == ("half_space", 0.5)
    assert found.modulus_at(0.0)[1][0] == pytest.approx(0.75 * TRUE["modulus"], rel=0.01)
    keys: Any = {key: value for key, value in solid.items() if key in ("young", "poisson", "branches")}
    assert asp.solids.half_space(**keys).modulus == pytest.approx(TRUE["modulus"], rel=0.01)


def test_the_end_sticks_and_a_liquid_drags():
    force = noisy(3, part=2e-3)
    last = TIME > 3
    force[last] -= 0.05 * FORCE.max()
    off = (TIME > 3.45) & (TIME < 3.6)
    force[off] -= 0.2 * FORCE.max()
    found = inferred(TIME, DEPTH, force=force, branches=1, **BALL)
    assert found.pull_off == pytest.approx(0.2 * FORCE.max(), rel=0.05)
    remarks = " ".join(found.remarks)
    assert "adhesive" in remarks
    assert "drag of a liquid" in remarks
    row = next(row for row in found.rows() if row.name == "pull-off force")
    work = found.pull_off / (1.5 * np.pi * RADIUS)
    assert f"by JKR (elastic) a work of adhesion of {work:.2g} J/m^2" in row.note


def test_a_drift_is_subtracted():
    rate = 2e-8
    found = inferred(
        TIME, DEPTH + rate * TIME, force=noisy(4, part=1e-4), drift="20 nm/s", branches=1, **BALL
    )
    assert found.verdicts["modulus"].value == pytest.approx(TRUE["modulus"], rel=0.01)


def test_creep_that_is_steady_at_the_end_of_a_hold_may_be_a_drift():
    slow = asp.relaxation.PronySeries(TRUE["modulus"], ((0.3, 50.0),))
    force = asp.theory.ting(TIME, DEPTH, slow, RADIUS)
    found = inferred(TIME, DEPTH, force=noisy(7, part=1e-4, force=force), branches=1, **BALL)
    assert any("drift of the instrument" in remark for remark in found.remarks)


def test_another_shape_misses_the_record_with_a_remark():
    record = Indentation.of(TIME[::4], DEPTH[::4], noisy(8, part=1e-3)[::4])
    found = inferred(record, model="cone", angle=70, branches=1)
    assert any("misses the data" in remark for remark in found.remarks)


def table(path, **columns):
    np.savetxt(
        path, np.column_stack([*columns.values()]), delimiter=",", header=",".join(columns), comments=""
    )
    return path


@pytest.mark.parametrize("height", ["tip_position_um", "piezo_um", "Height (um)"])
def test_words_of_machines(tmp_path, height):
    spring, zero = 0.05, 12.0
    bent = 0.0 if "tip" in height else FORCE / spring * 1e6
    columns = {"time_s": TIME, height: zero - (1e6 * DEPTH + bent), "force_nN": 1e9 * noisy(5, part=1e-4)}
    record, read = read_indentation(table(tmp_path / "record.csv", **columns), spring="0.05 N/m")
    assert "force from 'force_nN' in nN" in read
    assert record.contact is None  # to be fitted
    np.testing.assert_allclose(np.diff(record.depth), np.diff(DEPTH), atol=2e-9)
    np.testing.assert_allclose(record.force, FORCE, atol=1e-3 * FORCE.max())
    assert "falls into the body" in record.signs


def test_deflections_need_a_spring(tmp_path):
    columns = {"time_s": TIME, "indentation_um": 1e6 * DEPTH, "deflection_nm": FORCE / 0.05 * 1e9}
    path = table(tmp_path / "record.csv", **columns)
    record, _ = read_indentation(path, spring=0.05)
    np.testing.assert_allclose(record.force, FORCE, atol=1e-3 * FORCE.max())
    with refuses("spring", got="none"):
        read_indentation(path)


def test_units_and_columns_are_required(tmp_path):
    columns = {"time_s": TIME, "indentation": DEPTH, "force_nN": 1e9 * FORCE}
    path = table(tmp_path / "record.csv", **columns)
    with refuses(f"column 'indentation' of {path}", got="none"):
        read_indentation(path)
    record, _ = read_indentation(path, units="indentation=m")
    assert record.depth.max() == pytest.approx(1e-6)
    del columns["force_nN"]
    path = table(tmp_path / "short.csv", **columns)
    with refuses(str(path), got="columns 'time_s', 'indentation'"):
        read_indentation(path)


def test_what_is_no_record_is_refused():
    noise = 1e-12 * np.random.default_rng(0).standard_normal(TIME.size)
    twice, rows = np.append(TIME, TIME + 4.1), np.arange(10.0)
    again, weaker = np.append(DEPTH, DEPTH + 0.0), np.append(FORCE, 0.5 * FORCE)
    late, three, record = TIME > 3, [1.0, 2.0, 3.0], Indentation.of

    def ball(*data, **how):
        return lambda: inferred(*data, **how, **BALL)

    each_refuses(
        ("contact", "2e-06 m", lambda: record(TIME, DEPTH, FORCE, contact="2 um")),
        ("depth", "a depth that falls from the first row on", record, TIME[late], DEPTH[late], FORCE[late]),
        ("force", lambda: record(TIME, DEPTH, noise, contact="fit")),
        ("depth", "depths that rise again at 4.95 s", record, twice, again, weaker),
        ("time", "0.025 after 0.05", record, [0.0, 0.05, 0.025, *range(1, 8)], rows, rows),
        ("time", "3", record, TIME[:3], DEPTH[:3], FORCE[:3]),
        ("force", "5", record, TIME, DEPTH, FORCE[:5]),
        ("radius", "none", lambda: inferred(TIME, DEPTH, force=FORCE, model="ball")),
        ("model", lambda: inferred(TIME, DEPTH, force=FORCE, radius=RADIUS)),
        ("ramp", "1.0", ball(TIME, DEPTH, force=FORCE, ramp=1.0)),
        ("radius", "'10 um'", ball(three, three)),
        ("branches", "7", ball(TIME, DEPTH, force=FORCE, branches=7)),
        (
            *("prior of weight", "weight"),
            ball(TIME, DEPTH, force=noisy(6), priors={"weight": (1, 2)}, branches=1),
        ),
    )


@pytest.mark.slow
@pytest.mark.parametrize("rho", [0.0, 0.6])
def test_intervals_contain_what_made_the_record(rho):
    inside = dict.fromkeys(TRUE, 0)
    for seed in range(16):
        found = inferred(TIME, DEPTH, force=noisy(seed, rho), branches=1, **BALL)
        for name, value in TRUE.items():
            low, high = found.verdicts[name].profile
            inside[name] += low <= value <= high
    assert min(inside.values()) >= 12  # of 16 at 95 %: fewer once in 1000 times


def test_a_snap_in_and_an_offset_of_the_force_do_not_turn_it():
    """Of the largest force: attraction of a quarter before the contact, a baseline below 0, and one above."""
    force = noisy(0, part=0.005)
    most, before = force.max(), (TIME > 0.78) & (TIME < 0.86)
    for record, rest in ((force - 0.25 * most * before, 0.0), (force - most, -most), (force + most, most)):
        read = Indentation.of(TIME, DEPTH, record)
        assert read.signs == "depth grows into the body, forces above 0 press"
        assert read.baseline == pytest.approx(rest, abs=0.01 * most)
        np.testing.assert_allclose(read.force[TIME > 0.9], force[TIME > 0.9], atol=0.01 * most)


@pytest.mark.parametrize(
    ("begun", "lasting", "held"), [(0.0, 0.05, 10.0), (0.0, 0.5, 60.0), (0.5, 1.0, 60.0)]
)
def test_a_fast_approach_before_a_long_hold_is_read_and_relaxes(begun, lasting, held):
    """The first twentieth of the rows has the approach, too; the hold relaxes within its first rows."""
    time = np.linspace(0, held, 1001)
    depth = np.interp(time, (0, begun, begun + lasting), (-1e-7 * (begun > 0), 0, 1e-6))
    series = asp.relaxation.PronySeries(2000.0, ((0.4, 0.5),))
    force = noisy(5, part=2e-3, force=asp.theory.ting(time, depth, series, RADIUS))
    found = inferred(time, depth, force=force, branches=1, **BALL)
    assert found.record.signs == "depth grows into the body, forces above 0 press"
    at = np.array([0.1, 1.0, 10.0])
    np.testing.assert_allclose(found.modulus_at(at)[1], series.modulus_at(at), rtol=4e-3)
    begins = inferred(
        time[1:], np.full(1000, 1e-6), force=np.append(0.0, np.full(999, 1e-8)), branches=1, **BALL
    )
    assert "forces above 0 press" in begins.record.signs


@pytest.mark.parametrize("deep", [0.3, 0.95])
def test_a_tip_that_stays_in_contact_has_no_force_out_of_it(deep):
    time = np.linspace(0, 12, 601)
    depth = np.interp(time, (0, 1, 4, 5), (0, 1e-6, 1e-6, deep * 1e-6))
    elastic = 4 / 3 * np.sqrt(RADIUS) * 2000 * depth**1.5  # Hertz, both ways
    found = inferred(time, depth, force=noisy(6, part=1e-4, force=elastic), branches=1, **BALL)
    assert found.deviation[0] < 1e-3
    assert not any("out of contact" in remark for remark in found.remarks)


def test_rounding_of_a_depth_is_no_retraction():
    depth = np.minimum(TIME, 1.0) * 1e-6 + 2e-8 * TIME
    force = asp.theory.ting(TIME, np.minimum(TIME, 1.0) * 1e-6, SERIES, RADIUS)
    record = Indentation.of(TIME, depth, force, drift="20 nm/s")
    assert [name for name, *_ in record.segments] == ["approach", "hold"]
