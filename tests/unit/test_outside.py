"""A solid, a leg and a contact solver that are written outside the package go through all of it."""

import math
import os
import subprocess
import sys
from dataclasses import dataclass, replace
from typing import Annotated, Any

import numpy as np
import pytest
from annotated_types import Gt

import asperity as asp
from asperity.base.parameters import Quantity
from asperity.contact import ActiveSet
from asperity.errors import ConvergenceError, InputError
from asperity.protocols import Leg
from asperity.results import load_contact
from asperity.solids import Solid
from tests.refusals import refuses

MODULUS, SHARE, TIME = 3e9, 0.4, 50.0
INSIDE = asp.solids.half_space(modulus=MODULUS, branches=[(SHARE, TIME)])
TIMES = [1.0, 10.0, 100.0, 1000.0]


@dataclass(frozen=True)
class HalfSpace:
    """The stiffness of a half-space."""

    modulus: float

    def __call__(self, lattice):
        return self.modulus / 2 * lattice.wave_number * lattice.cell


def delayed(modulus, later, time, **facts):
    """A half-space with delayed elasticity: a spring in series with a spring beside a dashpot."""
    share = modulus / (modulus + later)
    return Solid(
        stiffness=HalfSpace(modulus),
        shares=[(share, time * (1 - share))],
        modulus=modulus,
        half_space=True,
        parameters={"later": later, "delay": time},
        kind="delayed",
        **facts,
    )


OUTSIDE = delayed(MODULUS, MODULUS * (1 - SHARE) / SHARE, TIME / (1 - SHARE))


@dataclass(frozen=True)
class Sine(Leg):
    """The load oscillates about what it was."""

    duration: Annotated[float, Gt(0), Quantity("how long it lasts", "s")]
    part: Annotated[float, Gt(0), Quantity("amplitude over the load")]
    period: Annotated[float, Gt(0), Quantity("period", "s")]
    target = "load"

    @property
    def longest(self):
        return self.period / 20

    def value(self, time, start):
        return start * (1 + self.part * math.sin(2 * math.pi * time / self.period))

    def words(self, say):
        return f"the load oscillates for {say('time', self.duration)}"


@dataclass(frozen=True)
class Wrapped:
    """Another solver, without whatever else it offers."""

    inner: ActiveSet

    def solve(self, problem, guess, accuracy):
        return self.inner.solve(problem, guess, accuracy)


def scan(edges="reflecting"):
    heights = 1e-7 * np.random.default_rng(3).normal(size=(32, 32)).cumsum(0).cumsum(1) / 32
    return asp.surfaces.Surface(heights, unit="m", pixel_size=(1e-6, 1e-6), length_unit="m", edges=edges)


def pressed(solid, edges="reflecting", **how):
    return asp.press(scan(edges), solid, load=1e-2, **how)


def assert_equal(one, other, rtol=1e-12):
    """Datasets with the same columns and numbers."""
    assert set(one.variables) == set(other.variables)
    for name in one.variables:
        scale = np.abs(other[name]).max() if other[name].dtype.kind == "f" else 1.0
        np.testing.assert_allclose(one[name], other[name], rtol=rtol, atol=rtol * float(scale), err_msg=name)


@pytest.mark.parametrize("edges", ["reflecting", "periodic"])
@pytest.mark.parametrize("exact", [True, False])
def test_a_half_space_from_outside_is_that_of_the_package(edges, exact):
    carried = asp.Carried(
        resistivity=1e-7, conductivity=200.0, poisson=0.3, shear=1e-3, friction_coefficient=0.3
    )
    runs = [
        asp.age(pressed(solid, edges), TIMES, fields_at=TIMES, carried=carried, exact=exact)
        for solid in (OUTSIDE, INSIDE)
    ]
    outside, inside = (run.dataset.drop_vars("residual") for run in runs)
    assert_equal(outside, inside, rtol=1e-9)
    ends = [run.final for run in runs]
    assert ends[0].area > pressed(OUTSIDE, edges).area
    for slip in (end.partial_slip(shear=1e-3, friction=0.3, poisson=0.3) for end in ends):
        assert slip.displacement > 0
    outside, inside = (asp.relax(end).dataset.drop_vars(["residual", "iterations"]) for end in ends)
    assert_equal(outside, inside, rtol=1e-6)
    assert runs[0].dataset.attrs["solid"] == "delayed"


def test_it_is_predicted():
    outside, inside = (
        asp.predict(solid, scan(), load=1e-2, first="1 s", last="1 ks", shear_strength="1 MPa")
        for solid in (OUTSIDE, INSIDE)
    )
    assert_equal(outside.dataset.drop_vars("residual"), inside.dataset.drop_vars("residual"), rtol=1e-9)
    assert outside.modulus == MODULUS
    assert outside.effective_load is not None and inside.effective_load is not None  # noqa: PT018
    np.testing.assert_allclose(outside.effective_load, inside.effective_load, rtol=1e-12)
    assert repr(outside)
    assert outside._repr_html_()


def test_it_is_saved_and_read_again(tmp_path):
    contact = asp.age(pressed(OUTSIDE), TIMES).final
    contact.save(tmp_path / "contact")
    again = load_contact(tmp_path / "contact", OUTSIDE)
    np.testing.assert_array_equal(again.in_contact, contact.in_contact)
    np.testing.assert_allclose(again.u0, contact.u0, atol=1e-18)
    with refuses("solid", "delay 50.0"):
        load_contact(tmp_path / "contact", delayed(MODULUS, MODULUS, TIME))
    assert "delayed" in OUTSIDE._repr_html_()


def leg_of(value=lambda _, start: start, longest=1.0, target="load"):
    """A leg of a class of its own."""

    @dataclass(frozen=True)
    class Own(Leg):
        duration: Annotated[float, Gt(0), Quantity("how long it lasts", "s")]

        def value(self, time, start):
            return value(time, start)

    return type("Own", (Own,), {"longest": longest, "target": target})(2.0)


@pytest.mark.parametrize("longest", [0.0, -1.0, math.nan, 1e-12, None])
def test_steps_that_follow_a_leg_last_for_a_while(longest):
    with refuses("longest", longest):
        leg_of(longest=longest)


def test_a_leg_prescribes_something_in_fields_that_say_what_they_are():
    with refuses("target", "'Load'"):
        leg_of(target="Load")

    @dataclass(frozen=True)
    class Bare(Leg):
        span: float

    with refuses("span", "one without"):
        Bare(1.0)


@pytest.mark.parametrize("wrong", [math.nan, math.inf, None, "1", 1j])
def test_what_a_leg_prescribes_is_a_number(wrong):
    with refuses("load"):
        asp.age(pressed(OUTSIDE), [1.0], protocol=leg_of(lambda time, start: wrong if time else start))


@dataclass(frozen=True)
class Wrong:
    """A solver whose answers are changed."""

    change: Any

    def solve(self, problem, guess, accuracy):
        return self.change(ActiveSet().solve(problem.spectral(), guess, accuracy))


ANSWERS = {
    "none": (lambda _: None, InputError),
    "list": (lambda found: replace(found, u=found.u.tolist()), InputError),
    "single": (lambda found: replace(found, u=found.u.astype("f4")), InputError),
    "shape": (lambda found: replace(found, u=found.u[:2]), InputError),
    "sites": (lambda found: replace(found, in_contact=found.in_contact.astype(int)), InputError),
    "nan": (lambda found: replace(found, u=found.u * math.nan), InputError),
    "below": (lambda found: replace(found, u=found.u - 0.1), InputError),
    "above": (lambda found: replace(found, u=found.u + 0.1 * ~found.in_contact), ConvergenceError),
}


@pytest.mark.parametrize("name", ANSWERS)
@pytest.mark.parametrize(
    "solid", [asp.solids.spring_lattice(k0=1.0, k1=3.0), OUTSIDE], ids=["springs", "body"]
)
def test_an_answer_that_is_none_is_told_of_whatever_asks_for_it(solid, name):
    change, error = ANSWERS[name]
    heights, solver = np.random.default_rng(0).normal(size=(16, 16)), Wrong(change)
    load = 0.03 * heights.size * (1.0 if solid is not OUTSIDE else MODULUS)
    contact = asp.press(heights, solid, load=load)
    for compute in (
        lambda: asp.press(heights, solid, load=load, solver=solver),
        lambda: asp.age(contact, [TIME / 50], solver=solver, exact=False),
        lambda: asp.relax(contact, solver=solver),
    ):
        with pytest.raises(error, match="solver") as told:
            compute()
        assert "more load" not in str(told.value)


def test_a_leg_and_a_solver_from_outside_go_on_from_a_checkpoint(tmp_path):
    place = asp.results.Checkpoint(tmp_path / "place.npz", every=0.0)
    legs = [asp.protocols.Hold(2.0), Sine(4.0, 0.2, 4.0), asp.protocols.Hold(3.0)]
    times, spent = [1.0, 3.0, 4.0, 5.0, 9.0], ["residual", "iterations", "steps", "rejected"]

    def stop(frame):
        if frame.time >= 4.0:
            raise InterruptedError

    def run(solver, solid=OUTSIDE, **more):
        contact = pressed(solid, solver=solver)
        return asp.age(contact, times, protocol=legs, solver=solver, **more).dataset

    with pytest.raises(InterruptedError):
        run(Wrapped(ActiveSet()), checkpoint=place, progress=stop)
    whole = run(Wrapped(ActiveSet()))
    assert_equal(run(Wrapped(ActiveSet()), checkpoint=place), whole, rtol=0)
    assert_equal(whole.drop_vars(spent), run(None, INSIDE).drop_vars(spent), rtol=1e-4)
    at = whole.sel(time=[3.0, 4.0, 5.0])["load"].values
    np.testing.assert_allclose(at, [1.2e-2, 1e-2, 0.8e-2], rtol=1e-7)


@dataclass(frozen=True)
class Law(asp.solids.LocalCreep):
    """A linear law, with an error or none."""

    offset: float = 0.0
    factor: float = 1.0
    slope: float = 1.0

    def velocity(self, stress):
        rate = 1e-15 * self.factor
        return rate * (stress + self.offset), np.full_like(stress, rate * self.slope)


@dataclass(frozen=True)
class Aimless(Sine):
    """It does not say what it prescribes, or says another word."""

    target: Annotated[str, Quantity("what it prescribes")] = ""


@pytest.mark.parametrize(
    ("name", "got", "wrong"),
    [
        ("stiffness", "6.45606e+15", lambda: pressed(of_law(lambda lattice: 1.5e9 * lattice.wave_number))),
        ("stiffness", "12912.1", lambda: pressed(of_law(HalfSpace(2 * MODULUS)))),
        ("rate", "another one", lambda: crept(Law(offset=1.0))),
        ("rate", "another one", lambda: crept(Law(factor=-1.0))),
        ("derivative", "2e-15", lambda: crept(Law(slope=2.0))),
        ("target", "''", lambda: followed(Aimless(1.0, 0.1, 1.0))),
        ("target", "'laod'", lambda: followed(Aimless(1.0, 0.1, 1.0, "laod"))),
    ],
)
def test_one_error_in_what_is_written_outside_is_refused(name, got, wrong):
    with refuses(name, got):
        wrong()


def of_law(law):
    return Solid(stiffness=law, shares=(), modulus=MODULUS, half_space=True)


def followed(leg):
    return asp.age(pressed(OUTSIDE), [1.0], protocol=leg)


def crept(law):
    return asp.age(pressed(asp.solids.half_space(modulus=MODULUS, creep=law)), [1.0])


def test_the_law_without_the_error_creeps():
    assert crept(Law()).final.area > 0


PLUGIN = """
from typing import Annotated
import numpy as np
from annotated_types import Gt
from asperity.base.parameters import Quantity
from asperity.solids import Solid, WaveNumberSpectrum
from asperity.surfaces.raw import RawSurface

def delayed(*, modulus: Annotated[float, Gt(0), Quantity("contact modulus", "Pa")],
            later: Annotated[float, Gt(0), Quantity("delayed modulus", "Pa")],
            delay: Annotated[float, Gt(0), Quantity("delay", "s")]) -> Solid:
    share = modulus / (modulus + later)
    stiffness, shares = WaveNumberSpectrum(modulus / 2), [(share, delay * (1 - share))]
    facts = dict(modulus=modulus, half_space=True, parameters={"later": later, "delay": delay})
    return Solid(stiffness=stiffness, shares=shares, kind="delayed", **facts)

def read(path):
    heights = np.frombuffer(path.read_bytes()[4:]).reshape(32, 32)
    return RawSurface(heights, "own", "own 1.0", unit="m", pixel_size=(1e-6, 1e-6), length_unit="m")
"""
ENTRIES = "[asperity.solids]\ndelayed = own:delayed\nbroken = own:nothing\n[asperity.scans]\nown = own:read\n"
KEYS = 'kind = "{}"\nmodulus = "3 GPa"\n'
DELAYED = KEYS.format("delayed") + 'later = "4.5 GPa"\ndelay = "83.333333333333333 s"\n'
ASKED = """
from asperity.app.cli import main
for words in (
    "run {0}.toml --out run_{0} --quiet --maps-at 1 100",
    "predict {0}.toml --out predicted_{0} --quiet",
    "law {0}.toml --times 10s --pressures 0.1MPa 1MPa --out law_{0} --quiet",
    "sweep {0}_sweep.toml --out campaign_{0} --workers 1 --quiet",
):
    for kind in ("delayed", "inside"):
        asked = words.format(kind).replace("run delayed.toml", "run other.toml --later 4.5GPa")
        assert main(asked.split()) == 0
"""


@pytest.mark.slow
def test_a_solid_and_a_format_of_another_distribution_pass_every_door(tmp_path):
    (tmp_path / "own.py").write_text(PLUGIN)
    (tmp_path / "own-1.0.dist-info").mkdir()
    (tmp_path / "own-1.0.dist-info" / "METADATA").write_text(
        "Metadata-Version: 2.1\nName: own\nVersion: 1.0\n"
    )
    (tmp_path / "own-1.0.dist-info" / "entry_points.txt").write_text(ENTRIES)
    heights = scan().heights
    (tmp_path / "scan.own").write_bytes(b"own\0" + np.ascontiguousarray(heights).tobytes())
    rest = '[contact]\npressure = "1 MPa"\n[aging]\nfirst = "1 s"\nlast = "100 s"\nper_decade = 3\n'
    rest += '[surface]\npath = "scan.own"\ntilt = "none"\n'
    inside = KEYS.format("half_space") + f"branches = [[{SHARE}, {TIME}]]\n"
    for kind, solid in (("delayed", DELAYED), ("inside", inside)):
        (tmp_path / f"{kind}.toml").write_text(f"[solid]\n{solid}{rest}")
        (tmp_path / "other.toml").write_text(f"[solid]\n{DELAYED.replace('4.5', '9')}{rest}")
        (tmp_path / f"{kind}_sweep.toml").write_text(
            f'[solid]\n{solid}{rest}[sweep]\nmodulus = ["2 GPa", "3 GPa"]\n'
        )
    env = os.environ | {"PYTHONPATH": os.pathsep.join([str(tmp_path), os.environ.get("PYTHONPATH", "")])}
    ended = subprocess.run(
        [sys.executable, "-c", ASKED], cwd=tmp_path, env=env, capture_output=True, text=True, timeout=200
    )
    assert (ended.returncode, "Traceback" in ended.stderr) == (0, False), ended.stderr
    assert "remark: own offers broken, which cannot be used" in ended.stderr
    for folder in ("run", "predicted", "law"):
        one, other = (asp.results.load(tmp_path / f"{folder}_{kind}") for kind in ("delayed", "inside"))
        columns = [name for name in other.data_vars if other[name].dtype.kind == "f" and name != "residual"]
        for name in columns:
            np.testing.assert_allclose(one[name], other[name], rtol=1e-7, err_msg=f"{folder} {name}")
