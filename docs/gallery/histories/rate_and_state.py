r"""
Which law of friction does a contact obey that slides and rests?
================================================================

Laws of rate and state say that friction depends on the velocity and on a state, the age of the contacts:

.. math:: \mu = \mu_0 + a \ln\frac{V}{V_0} + b \ln\frac{V_0 \theta}{D_c}, \qquad
          \dot\theta = 1 - \frac{V\theta}{D_c} \quad\text{or}\quad
          \dot\theta = -\frac{V\theta}{D_c} \ln\frac{V\theta}{D_c} .

The first is the aging law, under which contacts strengthen at rest. Under the slip law only slip changes
them. Here a rough profile slides under a viscoelastic half-space, rests, and slides again; the shear strength
of the contacts is constant, so that a = 0 and all that changes is the area.
"""

import matplotlib.pyplot as plt
import numpy as np

import asperity as asp

rough = asp.surfaces.spectral((256,), hurst=0.8, roll_off=64.0, cutoff=16.0, rms_height=1.0, seed=0)
solid = asp.solids.half_space(modulus=1.0, branches=[(0.1, 1.0), (0.1, 10.0), (0.1, 100.0)])
contact = asp.press(rough, solid, load=5.0)
protocol = asp.friction.slide_hold_slide(holds=[3.0, 10.0, 100.0], velocity=1.0, distance=8.0)
history = asp.age(contact, times=[8.0], protocol=protocol, rtol=0.02)
record = asp.friction.record_of(history, shear_strength=1.0)
laws = asp.friction.compare_state_laws(record)

fig, (upper, lower) = plt.subplots(2, 1, figsize=(5.4, 7.0), layout="constrained")
upper.plot(record.displacement, record.friction, "o", color="0.6", markersize=3, label="contact")
for law, line in (("aging", "-"), ("slip", "--")):
    upper.plot(record.displacement, laws.fits[law].predict(record), line, label=f"{law} law")
upper.set(xlabel="slip [sites]", ylabel="friction coefficient")
upper.legend()
for law, line, color in ((None, "o", "0.6"), ("aging", "-", "C0"), ("slip", "--", "C1")):
    peaks = laws.peaks(law)
    lower.semilogx(peaks.duration, peaks.peak - peaks.before, line, color=color)
lower.set(xlabel="hold time", ylabel="static friction − friction before")

# %%
# The verdict, and the same question to a record of which the law is known, with noise.

fit = laws.fits["aging"]
print(
    f"{laws.verdict}: b = {fit.b:.2f} ± {fit.b_stderr:.2f}, D_c = {fit.D_c:.1f} ± {fit.D_c_stderr:.1f} sites"
)

truth = asp.friction.RateAndState(law="slip", a=0.010, b=0.015, D_c=10e-6, mu_0=0.6, V_0=1e-6)
steps = asp.friction.velocity_steps([1e-6, 1e-5, 1e-6], distance=60e-6)
known = asp.friction.compare_state_laws(asp.friction.synthetic_record(steps, truth, noise=5e-4, seed=1))
print(f"{known.verdict}: {known.fits['slip']}")

# Origin: the parameters of which the second record is made; at rest, d theta/dt = 1 against 0.
assert laws.verdict == "aging"
assert known.verdict == "slip"
for name in ("a", "b", "D_c", "mu_0"):
    low, high = known.fits["slip"].interval(name)
    assert low < getattr(truth, name) < high
assert np.all(np.diff(laws.peaks().peak) > 0)
