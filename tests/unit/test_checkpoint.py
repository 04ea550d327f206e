"""A run that was stopped anywhere goes on to the identical result."""

import io
import subprocess
import sys
import time

import numpy as np
import pytest
import xarray as xr

import asperity as asp
from asperity.aging import creep
from asperity.aging.march import Midway
from asperity.contact import ActiveSet
from asperity.errors import InputError, OutputError
from asperity.results import Checkpoint
from tests.surfaces import correlated, uncorrelated

SOLID = asp.solids.spring_lattice(k0=1.0, k1=3.0)
CONTACT = asp.press(uncorrelated(16), SOLID, load=10.0)
TIMES = np.geomspace(1e-2, 1e4, 13)
KEEP = [0.0, 0.02, 100.0]
UNDISTURBED = asp.age(CONTACT, TIMES, fields_at=KEEP)


class StopHereError(Exception):
    """Stands for a kill."""


def stop_at(time):
    def progress(frame):
        if frame.time >= time:
            raise StopHereError

    return progress


@pytest.mark.parametrize("stops", [[TIMES[1]], [TIMES[6]], [TIMES[-1]], [TIMES[2], TIMES[5], TIMES[9]]])
def test_stopped_and_resumed(tmp_path, stops):
    checkpoint = Checkpoint(tmp_path / "place.npz", every=0.0)
    for stop in stops:
        with pytest.raises(StopHereError):
            asp.age(CONTACT, TIMES, fields_at=KEEP, checkpoint=checkpoint, progress=stop_at(stop))
    seen = []
    resumed = asp.age(
        CONTACT, TIMES, fields_at=KEEP, checkpoint=checkpoint, progress=lambda frame: seen.append(frame.time)
    )
    assert seen[0] == stops[-1]
    xr.testing.assert_identical(resumed.dataset, UNDISTURBED.dataset)
    np.testing.assert_array_equal(resumed.final.u0, UNDISTURBED.final.u0)
    np.testing.assert_array_equal(resumed.final.force, UNDISTURBED.final.force)


def test_stopped_and_resumed_where_errors_are_forgotten(tmp_path):
    solid = asp.solids.spring_lattice(k0=1.0, k1=100.0)
    contact = asp.press(correlated(48), solid, load=1e4)
    checkpoint, times = Checkpoint(tmp_path / "place.npz", every=0.0), [1e-2, 1.0, 100.0]
    undisturbed = asp.age(contact, times)
    moments: list[Midway] = []
    list(creep(contact, times, after_step=moments.append))
    forgetting = [bool(moment.resume_state["scales"][4]) for moment in moments]
    assert forgetting == sorted(forgetting)
    assert forgetting.count(True) > 10
    for stop in times[:2]:
        with pytest.raises(StopHereError):
            asp.age(contact, times, checkpoint=checkpoint, progress=stop_at(stop))
    resumed = asp.age(contact, times, checkpoint=checkpoint)
    xr.testing.assert_identical(resumed.dataset, undisturbed.dataset)
    np.testing.assert_array_equal(resumed.final.u0, undisturbed.final.u0)


P = asp.protocols
LEGS = [
    P.Ramp(1.0, load=75.0),
    P.Hold(3.0, hold="area"),
    P.Step(load=30.0),
    P.Hold(3.0, mobility=10.0),
    P.Ramp(1.0, separation=0.8),
    P.Hold(2.0),
]


@pytest.mark.parametrize("solver", [None, ActiveSet()], ids=["springs", "fields"])
def test_stopped_and_resumed_in_any_leg(tmp_path, solver):
    times = [0.5, 1.0, 2.0, 4.0, 6.0, 7.5, 9.0]
    contact = asp.press(uncorrelated(16), SOLID, load=60.0)
    arguments = {"contact": contact, "times": times, "protocol": LEGS, "fields_at": times, "solver": solver}
    undisturbed = asp.age(**arguments)
    checkpoint = Checkpoint(tmp_path / "place.npz", every=0.0)
    for stop in times:
        with pytest.raises(StopHereError):
            asp.age(**arguments, checkpoint=checkpoint, progress=stop_at(stop))
    resumed = asp.age(**arguments, checkpoint=checkpoint)
    xr.testing.assert_identical(resumed.dataset, undisturbed.dataset)
    np.testing.assert_array_equal(resumed.final.u0, undisturbed.final.u0)
    assert resumed.dataset["leg"].values.tolist() == [0, 0, 0, 1, 1, 2, 3, 3, 4, 4, 5, 5]


SLIDES = [
    P.Slide(3.0, velocity=2.0),
    P.Hold(1.0),
    P.Slide(2.0, velocity=np.inf, direction=(1, 1)),
    P.Slide(1.5, velocity=1.0, direction="y", substeps=2, every=2),
    P.Step(load=40.0),
    P.Hold(1.0),
]


@pytest.mark.parametrize("solver", [None, ActiveSet()], ids=["springs", "fields"])
def test_stopped_and_resumed_between_shifts(tmp_path, solver):
    times = [0.25, 0.75, 1.0, 2.0, 2.6, 3.5, 4.5, 5.0]
    contact = asp.press(uncorrelated(16), SOLID, load=60.0)
    arguments = {"contact": contact, "times": times, "protocol": SLIDES, "fields_at": times, "solver": solver}
    undisturbed = asp.age(**arguments)
    checkpoint = Checkpoint(tmp_path / "place.npz", every=0.0)
    for stop in times:
        with pytest.raises(StopHereError):
            asp.age(**arguments, checkpoint=checkpoint, progress=stop_at(stop))
    resumed = asp.age(**arguments, checkpoint=checkpoint)
    xr.testing.assert_identical(resumed.dataset, undisturbed.dataset)
    np.testing.assert_array_equal(resumed.final.u0, undisturbed.final.u0)
    np.testing.assert_array_equal(resumed.final.heights, undisturbed.final.heights)
    assert set(times) <= set(resumed.time.values.tolist())


def test_a_finished_run_resumes_to_the_same(tmp_path):
    path = tmp_path / "place.npz"
    for _ in range(2):
        history = asp.age(CONTACT, TIMES, fields_at=KEEP, checkpoint=Checkpoint(path, every=0.0))
        xr.testing.assert_identical(history.dataset, UNDISTURBED.dataset)


@pytest.mark.parametrize(
    "other",
    [
        {"times": TIMES[:-1]},
        {"times": TIMES[:-1], "fields_at": sorted([TIMES[-1], *KEEP])},
        {"rtol": 1e-3},
        {"fields_at": [100.0]},
        {"hold": "separation"},
        {"protocol": [P.Hold(TIMES[-1] / 2), P.Hold(TIMES[-1] / 2)]},
        {"contact": asp.press(uncorrelated(16), SOLID, load=10.5)},
        {"contact": asp.press(uncorrelated(16), asp.solids.spring_lattice(k0=1, k1=3, R=2), load=10.0)},
    ],
)
def test_the_checkpoint_of_another_run_is_refused(tmp_path, other):
    path = tmp_path / "place.npz"
    asp.age(CONTACT, TIMES, fields_at=KEEP, checkpoint=Checkpoint(path, every=0.0))
    arguments = {"contact": CONTACT, "times": TIMES, "fields_at": KEEP} | other
    with pytest.raises(InputError, match=r"of a run with other parameters; try another path, or remove"):
        asp.age(**arguments, checkpoint=path)


def test_a_file_that_is_no_checkpoint_is_refused(tmp_path):
    path = tmp_path / "place.npz"
    empty = io.BytesIO()
    np.savez(empty, facts=np.array("{}"))
    for content in (b"", b"hello", b"PK\x03\x04 cut off", empty.getvalue()):
        path.write_bytes(content)
        with pytest.raises(InputError, match="checkpoint: expected a checkpoint of this run"):
            asp.age(CONTACT, TIMES, checkpoint=path)
        assert path.read_bytes() == content


def test_a_place_where_nothing_can_be_written(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(OutputError, match="could not write"):
        asp.age(CONTACT, TIMES, checkpoint=Checkpoint(tmp_path / "file" / "place.npz", every=0.0))


def test_an_archive_that_cannot_be_decoded_is_no_checkpoint(tmp_path):
    path = tmp_path / "place.npz"
    asp.age(CONTACT, TIMES, checkpoint=Checkpoint(path, every=0.0))
    content = bytearray(path.read_bytes())
    content[content.index(b"PK\x01\x02") + 8] |= 1 << 5  # "compressed patched data"
    path.write_bytes(content)
    with pytest.raises(InputError, match=r"expected a checkpoint of this run, got .*compressed patched data"):
        asp.age(CONTACT, TIMES, checkpoint=path)


SCRIPT = """
import sys, numpy as np, asperity as asp
from asperity.results import Checkpoint
rough = np.random.default_rng(0).normal(size=(48, 48))
contact = asp.press(rough, asp.solids.spring_lattice(k0=1.0, k1=3.0), load=90.0)
history = asp.age(contact, np.geomspace(1e-2, 1e5, 29), checkpoint=Checkpoint(sys.argv[1], every=0.0))
print(*history.dataset["energy"].values.tolist(), history.final.u0.sum())
"""


def test_killed_at_random_moments(tmp_path):
    def run(path, patience=None):
        command = [sys.executable, "-c", SCRIPT, str(path)]
        return subprocess.run(command, capture_output=True, text=True, timeout=patience, check=True).stdout

    begin = time.monotonic()
    expected = run(tmp_path / "undisturbed.npz")
    usual = time.monotonic() - begin
    rng = np.random.default_rng(0)
    kills = 0
    for _ in range(6):
        try:  # the time-out kills with SIGKILL
            assert run(tmp_path / "place.npz", patience=usual * rng.uniform(0.3, 0.9)) == expected
        except subprocess.TimeoutExpired:
            kills += 1
    assert run(tmp_path / "place.npz") == expected
    assert kills > 0
