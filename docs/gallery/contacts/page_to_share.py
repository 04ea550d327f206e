r"""
How do I hand somebody a contact to explore?
============================================

``asperity explore`` shows a run as a page, on which time is a slider. The page can be written as one file
that holds everything and opens anywhere, without a server and without a network. It needs the extra
``explore`` to be written, and a browser to be read.
"""

import base64
import gzip
import html
import re
import subprocess
import sys
import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import asperity as asp
from asperity.app.explore.scene import unpack

rough = asp.surfaces.gaussian((64, 64), rms=1.0, seed=0)
contact = asp.press(rough, asp.solids.spring_lattice(k0=1.0, k1=3.0, R=1.0), load=80.0)
history = asp.age(contact, np.geomspace(1e-2, 1e4, 25), fields_at=[0.0, *np.geomspace(1e-2, 1e4, 13)])

fig, ax = plt.subplots(layout="constrained")
history.plot(ax, limit=asp.relax(contact))

# %%
# The command writes the page from what was saved. Here it is, in a frame: move the slider.

with tempfile.TemporaryDirectory() as folder:
    saved, page = Path(folder) / "aging.zarr", Path(folder) / "aging.html"
    history.save(saved)
    command = [sys.executable, "-m", "asperity", "explore", "--export", page, saved]
    subprocess.run(command, check=True, capture_output=True, timeout=120)
    text = page.read_text(encoding="utf-8")

print(f"one file of {len(text) / 1e3:.0f} kB, which may load nothing from elsewhere")


class Frame:
    """A page within a page, narrow enough that map, curve and slider are in sight together."""

    def _repr_html_(self):
        page, size = (
            html.escape(text),
            "width: 100%; max-width: 34rem; height: 1060px; border: 1px solid gray",
        )
        return f'<iframe srcdoc="{page}" title="A contact that ages" style="{size}"></iframe>'


Frame()

# %%
# The verdict: does the page hold the numbers of the run? Its data are messages, each behind its length,
# compressed.

stream = gzip.decompress(base64.b64decode(re.search(r'id="recording">([^<]*)', text)[1]))
messages = []
while stream:
    end = 8 + int.from_bytes(stream[:8], "little")
    messages.append(unpack(stream[8:end]))
    stream = stream[end:]
(scene, _), (_, rows), *_ = messages
area = rows["rows"][:, scene["columns"].index("area")]
print(
    f"area in the page: {area[0]:g} to {area[-1]:g} sites; in the run: {contact.area} to {history.final.area}"
)

# Origin: the history itself, which went through a folder, the command, and the page.
np.testing.assert_array_equal(area, history.area)
assert "default-src 'none'" in text
