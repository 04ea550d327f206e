r"""
At which speed does a rubber grip a rough track best?
=====================================================

Where a rubber slides, the track deforms it at the frequencies :math:`q V` of its waves. Slowly it flows with
them; fast it is a glass that touches little. In between it dissipates, and friction has a maximum. Each speed
is one contact problem with the complex modulus :math:`E^*(\omega)`; no time is marched. The loss factor is
shown below, at the speed at which a wave of 10 µm has that frequency.

Dashed is Persson's theory (J. Chem. Phys. 115, 3840 (2001)) for the same waves, without its correction for
partial contact: it counts a wave :math:`q` in the share :math:`P(q)` of the surface that touches if shorter
waves are left out.
"""

import matplotlib.pyplot as plt
import numpy as np
import scipy

import asperity as asp

# %%
# A rubber from 10 MPa to 1 GPa, whose relaxation times are spread about 10 µs, on a self-affine track.


times = 10.0 ** np.arange(-10, 0.1, 0.5)
shares = np.exp(-((np.log10(times) + 5) ** 2) / 6)
shares *= 0.99 / shares.sum()
branches = list(zip(shares.tolist(), times.tolist(), strict=True))
rubber = asp.solids.half_space(modulus="1 GPa", branches=branches)

heights = asp.surfaces.spectral((128, 128), hurst=0.8, roll_off=32.0, cutoff=6.0, rms_slope=0.2, seed=1)
track = asp.surfaces.Surface(np.asarray(heights), unit="um", pixel_size="1 um")
asked = {"pressure": "0.3 MPa", "speeds": ["10 nm/s", "100 m/s"], "per_decade": 2}
sliding = asp.steady_sliding(rubber, track, **asked)
speeds, friction = sliding["speed"].values, sliding["hysteresis_friction_coefficient"].values
contact = sliding["contact_fraction"].values

# %%
# Persson's theory: sums over the same waves, from long to short.


def modulus(frequency):
    """Complex contact modulus."""
    turns = 1j * frequency[..., None] * times
    return 1e9 * (0.01 + (shares * turns / (1 + turns)).sum(-1))


def persson(speed):
    """Friction coefficient and contact fraction."""
    power = np.abs(np.fft.fft2(1e-6 * heights) / heights.size) ** 2
    qy, qx = np.meshgrid(*2 * [2 * np.pi * np.fft.fftfreq(128, 1e-6)], indexing="ij")
    q, response = np.hypot(qy, qx), modulus(qx * speed) / 0.3e6
    order = np.argsort(q, axis=None)
    stress = np.cumsum((q**2 * np.abs(response) ** 2 * power).flat[order]) / 8
    touching = scipy.special.erf(1 / (2 * np.sqrt(np.maximum(stress, 1e-12))))
    dissipated = (q * qx * response.imag * power / 2).flat[order]
    return (dissipated * touching).sum(), touching[-1]


theory = np.array([persson(speed) for speed in speeds])

# %%
# Friction is largest where the loss factor of waves of some 10 µm is, and the area falls to a thirtieth. The
# theory has the same limits and the same shape; without its correction it overestimates friction in small
# contacts.

fig, axes = plt.subplots(3, sharex=True, figsize=(5.6, 6.4), layout="constrained")
many = np.geomspace(speeds[0], speeds[-1], 200)
loss = modulus(2 * np.pi / 10e-6 * many)
for panel, found, known in ((axes[0], friction, theory[:, 0]), (axes[1], contact, theory[:, 1])):
    panel.plot(speeds, found, "o-", label="this surface")
    panel.plot(speeds, known, "k--", label="Persson's theory")
axes[2].plot(many, loss.imag / loss.real)
axes[0].legend()
axes[0].set(xscale="log", ylabel="friction coefficient")
axes[1].set(yscale="log", ylabel="contact fraction")
axes[2].set(ylabel="E''/E' at a wave of 10 µm", xlabel="sliding speed [m/s]", ylim=(0, None))

# %%
at = int(np.argmax(friction))
print(f"largest friction {friction[at]:.3f} at {speeds[at]:.1g} m/s")
print(f"contact {contact[0]:.2f} to {contact[-1]:.4f}")

# Origin: power balance. Friction is the loss of the branches, so it vanishes where these do not move.
assert friction.min() > 0
assert 0 < at < speeds.size - 1
assert friction[[0, -1]].max() < 0.1 * friction[at]
assert (np.diff(contact) <= 0).all()
assert np.allclose(friction[:4], theory[:4, 0], rtol=0.2)
