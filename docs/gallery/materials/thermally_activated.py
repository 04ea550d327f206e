r"""
How does the logarithm depend on temperature?
=============================================

Where creep is activated by stress (Eyring's law), contacts flow with the velocity

.. math:: v = v_0 \sinh\frac{s}{s_0}, \qquad v_0 = v_\infty e^{-Q/kT}, \qquad s_0 = \frac{kT}{\Omega}.

The heavy contacts soon carry about the same force s, which falls by :math:`s_0` whenever time grows e-fold.
The area, load over s, then grows by about the share

.. math:: B = \frac{d\ln A}{d\ln t} \approx \frac{s_0}{s} = \frac{kT}{Q - kT \ln(t/t_0)},

in proportion to the temperature as long as kT is small against Q: a logarithm without a spectrum of times.
Light contacts do not creep, which makes B smaller than that by a factor that hardly depends on temperature.
"""

import matplotlib.pyplot as plt
import numpy as np

import asperity as asp

rough = asp.surfaces.gaussian((96, 96), rms=1.0, seed=0)
times = np.geomspace(1.0, 1e3, 7)
barrier, prefactor = 1.0, 1e3  # Q / Omega, a force; kT in its unit

fig, (upper, lower) = plt.subplots(2, 1, figsize=(5.4, 7.0), layout="constrained")
warmth, slopes, theory = [0.01, 0.02, 0.03, 0.04, 0.06], [], []
for thermal, marker in zip(warmth, "vos^D", strict=True):
    law = asp.solids.Eyring(rate=prefactor * np.exp(-barrier / thermal), stress=thermal)
    solid = asp.solids.spring_lattice(k0=0.02, k1=3.0, R=0.0, creep=law)
    history = asp.age(asp.press(rough, solid, load=0.05 * rough.size), times, rtol=0.01).dataset
    area, load = history["area"].sel(time=times).values, history["load"].sel(time=times).values
    slopes.append(np.polyfit(np.log(times), area / area.mean(), 1)[0])
    theory.append(thermal / np.mean(load / area))
    upper.semilogx(times, area / area[0], f"{marker}-", linewidth=0.8, label=f"kT = {thermal}")
upper.set(xlabel="hold time $t$", ylabel="$A(t) / A(1)$")
upper.legend()
lower.plot(warmth, slopes, "o", color="tab:blue", label="$B$ found")
lower.plot([0, *warmth], [0, *theory], "--", color="gray", label="$s_0 / s$")
lower.set(xlabel="$kT$ over $Q$", ylabel="growth of the area per e-fold of time")
lower.legend()

# %%
# The verdict.

for thermal, slope, expected in zip(warmth, slopes, theory, strict=True):
    print(f"kT/Q = {thermal}: B = {slope:.4f}, s0/s = {expected:.4f}")

# Origin: s0 over the mean contact force, less what light contacts, which do not creep, carry; measured.
ratio = np.divide(slopes, theory)
assert ((ratio > 0.5) & (ratio < 0.85)).all()
# Nearly in proportion to T while kT ln(t/t0) is small against Q, and faster above.
np.testing.assert_allclose(np.divide(slopes, warmth)[:2], slopes[0] / warmth[0], rtol=0.1)
assert slopes[-1] / warmth[-1] > 1.5 * slopes[0] / warmth[0]
