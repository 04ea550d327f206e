r"""
How do I show aging in a talk?
==============================

``fields_at`` keeps maps of the contact, and ``animate`` draws them one after the other beside the growth
of the area: as a GIF, or as MP4 where ffmpeg is installed. A notebook shows the animation with a player.

There is one map a decade here. Contacts grow with the logarithm of time, so that pictures at equal steps
of time would show nearly all of the growth between the first two.
"""

import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from PIL import Image

import asperity as asp

rough = asp.surfaces.gaussian((96, 96), rms=1.0, seed=0)
contact = asp.press(rough, asp.solids.spring_lattice(k0=1.0, k1=3.0, R=1.0), load=180.0)
moments = np.geomspace(1e-3, 1e3, 7)
history = asp.age(contact, np.geomspace(1e-3, 1e3, 25), fields_at=moments)

# %%
# The file is in a folder that is removed. Give a name of your own to keep it.

with tempfile.TemporaryDirectory() as folder:
    talk = Path(folder) / "aging.gif"
    history.animate(talk, frames_per_second=2)
    with Image.open(talk) as film:
        frames = film.n_frames
        film.seek(frames - 1)
        last = np.asarray(film.convert("RGB"))
    print(f"{frames} pictures, {talk.stat().st_size / 1e3:.0f} kB")

fig, ax = plt.subplots(figsize=(8.0, 4.0), layout="constrained")
ax.imshow(last)
ax.set_axis_off()

# %%
# The verdict on that: which part of the growth the first of seven equal steps of time would show.

area = history["area"]
early = int(area.sel(time=moments[-1] / 7, method="nearest"))
part = (early - contact.area) / (history.final.area - contact.area)
print(f"{part:.0%} of the growth is over at a seventh of the time")

# Origin: the relaxed state, found without any steps in time, is the end of the film; and one picture a
# map.
assert frames == len(moments)
assert abs(history.final.area / asp.relax(contact).area - 1) < 0.02
assert part > 0.85
