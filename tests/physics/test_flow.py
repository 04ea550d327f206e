"""Spheres that sink by flow, dissolution and diffusion spread as powers of time."""

import numpy as np
import pytest

import asperity as asp


@pytest.mark.parametrize(
    "exponent",
    [-1, 0, *(pytest.param(n, marks=pytest.mark.slow) for n in (1, 2))],
    ids=["flow", "dissolved", "volume", "surface"],
)
def test_a_sphere_spreads_as_its_mechanism_has_it(exponent):
    # Sinking a^2/R in a time t at the velocity M p, with M ~ a^-n and p ~ F/a^2, makes a ~ t^(1/(n+4)), as
    # long as the contact has many sites, much more than at first, and is far below the period of 64 sites.
    n, radius, load, widest = 64, 100.0, 0.02, 12.0
    x = np.arange(n) - n / 2
    heights = -((x[:, None] - 0.31) ** 2 + (x + 0.23) ** 2) / (2 * radius)
    solid = asp.solids.half_space(modulus=1.0, flow=(1.0, exponent))
    contact = asp.press(heights, solid, load=load)
    assert contact.area == 5
    scale = widest ** (exponent + 4) / radius / load
    times = scale * np.geomspace(3e-4 * 10.0 ** -(exponent == -1), 2, 20)
    area = asp.age(contact, times, rtol=1e-2).dataset["area"].values[1:]
    a = np.sqrt(area / np.pi)
    window = (a > 4) & (a < widest)
    assert window.sum() >= 5
    slope = np.polyfit(np.log(times[window]), np.log(a[window]), 1)[0]
    # The next exponents are a fifth and more away.
    assert slope == pytest.approx(1 / (exponent + 4), rel=0.06)
