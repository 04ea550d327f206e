"""A run that was stopped anywhere goes on to the identical result."""

import io
import zipfile
from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest
import xarray as xr

import asperity as asp
from asperity.aging import creep
from asperity.aging.frames import Midway
from asperity.contact import ActiveSet, Multigrid
from asperity.errors import CheckpointError, OutputError
from asperity.inference.models import of_name
from asperity.inference.problem import Problem
from asperity.inference.sampling import sample
from asperity.results import Checkpoint
from tests.refusals import refuses
from tests.surfaces import uncorrelated

SOLID = asp.solids.spring_lattice(k0=1.0, k1=3.0)
CONTACT = asp.press(uncorrelated(16), SOLID, load=10.0)
TIMES = np.geomspace(1e-2, 1e4, 13)
KEEP = [0.0, 0.02, 100.0]


def stop_at(time):
    def progress(frame):
        if frame.time >= time:
            raise InterruptedError  # stands for a kill

    return progress


P = asp.protocols
LEGS = [
    P.Ramp(1.0, load=75.0),
    P.Hold(3.0, hold="area"),
    P.Step(load=30.0),
    P.Hold(3.0, mobility=10.0),
    P.Ramp(1.0, separation=0.8),
    P.Hold(2.0),
]
SLIDES = [
    P.Slide(3.0, velocity=2.0),
    P.Hold(1.0),
    P.Slide(2.0, velocity=np.inf, direction=(1, 1)),
    P.Slide(1.5, velocity=1.0, direction="y", substeps=2, every=2),
    P.Step(load=40.0),
    P.Hold(1.0),
]
HEAVY = asp.press(uncorrelated(16), SOLID, load=60.0)
IN_LEGS, BETWEEN_SHIFTS = [0.5, 1.0, 2.0, 4.0, 6.0, 7.5, 9.0], [0.25, 0.75, 1.0, 2.0, 2.6, 3.5, 4.5, 5.0]
YIELDS = [P.Ramp(1.0, load=80.0), P.Step(load=90.0), P.Hold(1.0), P.Slide(1.0, velocity=1.0)]
EASED = [P.Hold(1.0), P.Step(load=4.0), P.Hold(5.0), P.Ramp(1.0, load=9.0)]
EYRING = asp.solids.Eyring(rate=0.1, stress=0.2)
SMALL = uncorrelated(16)[:12, :12]
SOLIDS = {
    "a law on springs": asp.solids.spring_lattice(k0=1.0, k1=3.0, R=0.1, creep=EYRING),
    "a law": asp.solids.half_space(modulus=3.0, creep=asp.solids.Garofalo(0.1, 0.2, 1.5)),
    "a law beside a permanent share": asp.solids.half_space(modulus=3.0, creep=EYRING, permanent=0.4),
    "springs that no others join": asp.solids.spring_lattice(k0=0.0, k1=3.0),
    "branches": asp.solids.half_space(modulus=3.0, branches=[(0.3, 0.5), (0.3, 5.0)]),
    "a rigid machine": asp.solids.half_space(modulus=3.0, branches=[(0.3, 0.5)], apparatus=np.inf),
}


def run_of(contact, times, protocol=None, **others):
    return {"contact": contact, "times": times, "protocol": protocol, **others}


def yielding(creep):
    solid = asp.solids.spring_lattice(k0=1.0, k1=3.0, creep=creep, hardness=1.0)
    contact = asp.press(uncorrelated(16), solid, load=40.0)
    return run_of(contact, [0.5, 1.5, 2.0, 2.5], YIELDS, rtol=2e-2, fields_at=[0.0, 1.5])


ELASTIC = asp.press(SMALL, SOLIDS["branches"], load=8.0)
UNLOADED = asp.press(SMALL, SOLIDS["branches"], load=0.0)
ABOVE = asp.press(uncorrelated(16), SOLID, separation=float(uncorrelated(16).max()) + 0.3)
LEFT_TO_FIELDS: dict[str, Any] = {"contact": CONTACT, "times": TIMES, "solver": Multigrid(max_cycles=0)}
RUNS: dict[str, tuple[dict[str, Any], Sequence[float]]] = {
    "often": (run_of(CONTACT, TIMES, fields_at=KEEP), [TIMES[1], TIMES[5], TIMES[-1]]),
    "where cycles get nowhere": (LEFT_TO_FIELDS, [TIMES[1], TIMES[8]]),
    "yielding": (yielding(None), [0.5, 1.5, 2.0, 2.5]),
    "yielding by a law": (yielding(asp.solids.Eyring(rate=1e-2, stress=0.3)), [0.5, 1.5, 2.0, 2.5]),
    "exact": (run_of(ELASTIC, [0.1, 1.0, 10.0]), [0.1, 1.0]),
    "from no load": (
        run_of(UNLOADED, [0.3, 1.2, 3.0], [P.Ramp(2.4, load=9.0), P.Ramp(1.0, load=4.0)]),
        [1.2, 3.0],
    ),
    "from above": (run_of(ABOVE, [0.1, 0.7, 1.5], [P.Ramp(1.0, separation=1.0), P.Hold(1.0)]), [0.7, 1.5]),
}
AGES = asp.Carried(strength=asp.friction.ShearStrength(0.5, growth=0.1, after=0.1, renewal=2.0))
for of, how in (("ages", {"carried": AGES}), ("fields", {"solver": ActiveSet()})):
    for name, protocol, times in (("legs", LEGS, IN_LEGS), ("shifts", SLIDES, BETWEEN_SHIFTS)):
        RUNS[f"{name}, {of}"] = run_of(HEAVY, times, protocol, fields_at=times, **how), times
for name, solid in SOLIDS.items():
    RUNS[name] = run_of(asp.press(SMALL, solid, load=8.0), [0.5, 2.0, 6.0, 6.5], EASED), [0.5, 2.0, 6.5]


@pytest.mark.parametrize("name", RUNS)
def test_stopped_and_resumed(tmp_path, name):
    arguments, stops = RUNS[name]
    undisturbed = asp.age(**arguments)
    checkpoint = Checkpoint(tmp_path / "place.npz", every=0.0)
    for stop in stops:
        with pytest.raises(InterruptedError):
            asp.age(**arguments, checkpoint=checkpoint, progress=stop_at(stop))
    seen: list[float] = []
    resumed = asp.age(**arguments, checkpoint=checkpoint, progress=lambda frame: seen.append(frame.time))
    assert seen[0] == stops[-1]
    assert set(arguments["times"]) <= set(resumed.time.values.tolist())
    finished = asp.age(**arguments, checkpoint=checkpoint)
    for history in (resumed, finished):
        xr.testing.assert_identical(history.dataset, undisturbed.dataset)
    if name == "exact":
        assert "exact_contact" in undisturbed.dataset.attrs
    if name.startswith("yielding"):
        assert undisturbed.dataset["permanent_indentation"].max() > 0
    for field in ("u", "anchors", "force", "heights", "permanent_indentation"):
        np.testing.assert_array_equal(getattr(resumed.final, field), getattr(undisturbed.final, field))


def test_whole_fields_take_over_where_cycles_get_nowhere_and_frames_say_so():
    moments: list[Midway] = []
    frames = list(creep(**LEFT_TO_FIELDS, after_step=lambda midway, *_: moments.append(midway())))
    assert {moment.kind for moment in moments} == {"fields"}
    assert [frame.solved_by for frame in frames] == ["", *len(TIMES) * ["fields"]]


def test_the_checkpoint_of_another_run_is_refused(here):
    arguments, _ = RUNS["often"]
    asp.age(**arguments, checkpoint=Checkpoint("place.npz", every=0.0))
    of_a_law = asp.press(SMALL, SOLIDS["a law"], load=8.0)
    asp.age(of_a_law, [1.0], checkpoint=Checkpoint("law.npz", every=0.0))
    other_law = asp.solids.half_space(modulus=3.0, creep=asp.solids.Garofalo(0.1, 0.3, 1.5))
    with refuses("checkpoint", kind=CheckpointError):
        asp.age(asp.press(SMALL, other_law, load=8.0), [1.0], checkpoint="law.npz")
    faster = asp.solids.spring_lattice(k0=1, k1=3, R=2)
    for other in (
        {"times": TIMES[:-1], "fields_at": sorted([TIMES[-1], *KEEP])},
        {"rtol": 1e-3},
        {"fields_at": [100.0]},
        {"hold": "separation"},
        {"protocol": [P.Hold(TIMES[-1] / 2), P.Hold(TIMES[-1] / 2)]},
        {"contact": asp.press(uncorrelated(16), SOLID, load=10.5)},
        {"contact": asp.press(uncorrelated(16), faster, load=10.0)},
    ):
        with refuses("checkpoint", kind=CheckpointError):
            asp.age(**(arguments | other), checkpoint="place.npz")


def test_a_file_that_is_no_checkpoint_is_refused(here):
    asp.age(CONTACT, TIMES, checkpoint=Checkpoint("place.npz", every=0.0))
    patched = bytearray((here / "place.npz").read_bytes())
    patched[patched.index(b"PK\x01\x02") + 8] |= 1 << 5  # "compressed patched data", which cannot be decoded
    empty = io.BytesIO()
    np.savez(empty, facts=np.array("{}"))
    for content in (b"", b"hello", b"PK\x03\x04 cut off", empty.getvalue(), bytes(patched)):
        (here / "place.npz").write_bytes(content)
        with refuses("checkpoint", kind=CheckpointError):
            asp.age(CONTACT, TIMES, checkpoint="place.npz")
        assert (here / "place.npz").read_bytes() == content


def infer(place):
    error = np.full(TIMES.size, 0.02)
    made = of_name("power", TIMES, TIMES**0.1)
    how: dict[str, Any] = {"seed": 0, "walkers": 50, "effective": 50, "agreement": 1.2}
    return sample(Problem(TIMES, TIMES**0.1, error, made), **how, checkpoint=place).z


def law(place):
    scan = asp.surfaces.Surface(uncorrelated(16), unit="nm", pixel_size=(1.0, 1.0), length_unit="um")
    found = asp.law(asp.solids.half_space(modulus="3 GPa"), scan, pressures=[1e5, 2e5], checkpoint=place)
    return found["approach"].values


def age(place):
    return asp.age(CONTACT, TIMES, fields_at=[1.0], checkpoint=place).dataset["u"].values


@pytest.mark.parametrize("compute", [age, law, infer])
def test_a_changed_number_is_refused(here, compute):
    place = here / "place"
    whole = compute(Checkpoint(place, every=0.0))
    written = place.read_bytes()
    np.testing.assert_array_equal(compute(place), whole)
    with zipfile.ZipFile(place) as archive:
        contents = {name: archive.read(name) for name in archive.namelist()}
    assert {"mark.npy", "facts.npy"} <= set(contents)
    for content in contents.values():
        changed = bytearray(written)
        changed[written.index(content) + len(content) - 4] ^= 1  # the last letter, or a digit of a number
        place.write_bytes(changed)
        with refuses("checkpoint", "CRC", kind=CheckpointError):
            compute(place)
        assert place.read_bytes() == changed


def test_a_place_where_nothing_can_be_written(here):
    (here / "file").write_text("")
    with pytest.raises(OutputError, match="could not write"):
        asp.age(CONTACT, TIMES, checkpoint=Checkpoint("file/place.npz", every=0.0))
