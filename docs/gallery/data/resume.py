r"""
What is left of a long run that is killed?
==========================================

Everything up to its checkpoint. This script starts an aging in a process of its own, kills that process
without warning, and calls ``age`` again with the same arguments and the same checkpoint. The run goes on
from there, and ends at the same numbers, to the last bit. ``asperity run`` and campaigns do so by
themselves.
"""

import subprocess
import sys
import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import asperity as asp

RUN = """
import sys, time
import numpy as np
import asperity as asp

rough = asp.surfaces.gaussian((200, 200), rms=1.0, seed=0)
contact = asp.press(rough, asp.solids.spring_lattice(k0=1.0, k1=3.0, R=1.0), load=800.0)
times = np.geomspace(1e-3, 1e6, 28)
place = asp.Checkpoint(sys.argv[1], every=0)  # by default every ten seconds


def tell(frame):
    print(frame.time, flush=True)
    if frame.time >= 1.0:
        time.sleep(600)  # the rest takes long
"""

with tempfile.TemporaryDirectory() as folder:
    place = Path(folder) / "place.npz"
    job = [sys.executable, "-c", RUN + "asp.age(contact, times, checkpoint=place, progress=tell)", str(place)]
    with subprocess.Popen(job, stdout=subprocess.PIPE, text=True) as process:
        for line in process.stdout:
            if float(line) >= 1.0:
                process.kill()  # SIGKILL, where there are signals
                break
    print(f"killed at t = {float(line):.3g}, exit status {process.returncode}")

    rough = asp.surfaces.gaussian((200, 200), rms=1.0, seed=0)
    contact = asp.press(rough, asp.solids.spring_lattice(k0=1.0, k1=3.0, R=1.0), load=800.0)
    times = np.geomspace(1e-3, 1e6, 28)
    computed = []
    resumed = asp.age(contact, times, checkpoint=place, progress=lambda frame: computed.append(frame.time))

undisturbed = asp.age(contact, times)

# %%
# What was read from the checkpoint, and what was computed after it.

time, area = resumed.dataset["time"].values[1:], resumed.dataset["area"].values[1:]
kept = time < computed[0]
fig, ax = plt.subplots(layout="constrained")
ax.semilogx(
    *(undisturbed.dataset[name].values[1:] for name in ("time", "area")),
    "-",
    color="0.7",
    linewidth=4,
    label="undisturbed",
)
ax.semilogx(time[kept], area[kept], "o", color="tab:blue", label="before the kill, from the checkpoint")
ax.semilogx(time[~kept], area[~kept], "o", color="tab:orange", label="after it")
ax.set(xlabel=r"hold time $t$ [$1/(k_0 R)$]", ylabel="contact area [sites]")
ax.legend()
print(f"{kept.sum()} of {time.size} times were read, {(~kept).sum()} computed")

# Origin: the same run without a kill.
assert process.returncode != 0
assert 0 < kept.sum() < time.size
for name in ("area", "separation", "energy", "residual"):
    np.testing.assert_array_equal(resumed.dataset[name], undisturbed.dataset[name])
np.testing.assert_array_equal(resumed.final.u, undisturbed.final.u)
