"""Animations of a history: one frame a map, in a file or in a player."""

import re
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
import pytest
from matplotlib.animation import FFMpegWriter
from matplotlib.colors import to_rgb
from PIL import Image

from asperity import age, press, protocols
from asperity.errors import OutputError
from asperity.solids import spring_lattice
from asperity.surfaces import gaussian
from tests.refusals import refuses

SOLID = spring_lattice(k0=1.0, k1=3.0)


pytestmark = pytest.mark.usefixtures("no_display")


@pytest.fixture(scope="module")
def aged():
    contact = press(gaussian((24, 24)), SOLID, load=20.0)
    return age(contact, [0.1, 1.0, 10.0], fields_at=[0.0, 0.5, 10.0], rtol=1e-2)


def test_each_frame_is_a_map_and_its_time(aged):
    film: Any = aged.animate()
    black = to_rgb("black")
    left_end = film._fig.axes[1].get_xlim()[0]
    for number, time in enumerate((left_end, 0.5, 10.0)):
        film._func(number)
        left, right = film._fig.axes
        drawn = left.images[0].get_array()
        assert right.lines[-1].get_xdata()[0] == pytest.approx(time)
        touching = aged["in_contact"].values[number]
        kept = touching & aged["in_contact"].values[0]
        np.testing.assert_array_equal((drawn == black).all(axis=-1), kept)
        np.testing.assert_array_equal((drawn != 1).any(axis=-1), touching | aged["in_contact"].values[0])
    player = film._repr_html_()
    assert "<img" in player
    assert "▶" in player
    assert not re.search(r"https?://|fa-", player)  # it needs no network


def test_a_gif_has_a_frame_for_each_map(aged, tmp_path):
    path = tmp_path / "aging.gif"
    aged.animate(path, frames_per_second=5, quantity="separation")
    with Image.open(path) as image:
        assert image.n_frames == 3  # type: ignore[attr-defined]
        assert image.info["duration"] == 200
    assert not plt.get_fignums()
    with pytest.raises(OutputError, match="kept"):
        aged.animate(path)
    assert [file.name for file in tmp_path.iterdir()] == ["aging.gif"]


def test_profiles_and_protocols_are_animated():
    contact = press(gaussian((64,)), SOLID, load=6.0)
    legs = [protocols.Hold(10.0), protocols.Step(load=3.0), protocols.Hold(10.0)]
    history = age(contact, [0.1, 11.0], protocol=legs, fields_at=[0.0, 10.0, 20.0], rtol=1e-2)
    film: Any = history.animate()
    film._draw_was_started = True
    left, right = film._fig.axes
    places = []
    for number, touching in enumerate(history["in_contact"].values):
        film._func(number)
        marks = [line.get_xdata() for line in left.lines if line.get_marker() == "s"]
        np.testing.assert_array_equal(np.sort(np.concatenate(marks)), np.flatnonzero(touching))
        places.append(float(right.lines[-1].get_xdata()[0]))
    assert history["field_leg"].values.tolist() == [0, 0, 1, 2]  # before and after the step
    assert places == sorted(set(places))


def test_what_cannot_be_animated_is_refused(aged, tmp_path, monkeypatch: pytest.MonkeyPatch):
    with refuses("dataset"):
        age(aged.final, [1.0]).animate()
    with refuses("path"):
        aged.animate("aging.avi")
    with refuses("quantity"):
        aged.animate(quantity="friction")
    with refuses("frames_per_second"):
        aged.animate(frames_per_second=0)
    monkeypatch.setattr(FFMpegWriter, "isAvailable", lambda: False)
    with refuses("path"):
        aged.animate("aging.mp4")
    assert not plt.get_fignums()


@pytest.mark.skipif(not FFMpegWriter.isAvailable(), reason="no ffmpeg is installed")
def test_an_mp4_is_written(aged, tmp_path):
    aged.animate(tmp_path / "aging.mp4")
    assert (tmp_path / "aging.mp4").read_bytes()[4:8] == b"ftyp"
