"""A ramp from no load: the exact contact under the effective load, and an explicit integrator."""

import numpy as np
import pytest

import asperity as asp
from tests.history_reference import explicit_history
from tests.refusals import refuses

P = asp.protocols
LASTING, LOAD = 2.4, 100.0


@pytest.fixture(scope="module")
def rough():
    heights = asp.surfaces.self_affine(64, hurst=0.8, delta=0.05, seed=1)
    return heights / heights.std()


def test_area_of_a_ramp_is_elastic_under_the_effective_load(rough):
    series = asp.relaxation.PronySeries(10.0, ((0.3, 0.5), (0.3, 20.0)))
    solid = asp.solids.half_space(modulus=10.0, branches=series.branches)
    elastic = asp.solids.half_space(modulus=10.0)
    times = np.array([0.01, 0.6, 1.2, LASTING, 3.0, 30.0])
    history = asp.age(
        asp.press(rough, solid, load=0.0), times, protocol=[P.Ramp(LASTING, load=LOAD), P.Hold(30.0)]
    )
    loads = np.minimum(times / LASTING, 1) * LOAD
    effective = series.effective_load([0.0, *times], [0.0, *loads])[1:]
    wanted = [asp.press(rough, elastic, load=load).area for load in effective]
    found = history.dataset.sel(time=times)
    assert found["area"].values.tolist() == wanted
    np.testing.assert_allclose(found["load"], loads, rtol=1e-9)
    assert history.dataset["load"].values[0] == 0


def test_ramp_on_springs_follows_an_explicit_integrator():
    rough = asp.surfaces.gaussian((16, 16), rms=1.0, seed=3)
    times = np.array([0.5, 1.0, 2.0])
    solid = asp.solids.spring_lattice(k0=1.0, k1=3.0, R=1.0)
    history = asp.age(
        asp.press(rough, solid, load=0.0),
        times,
        protocol=[P.Ramp(1.0, load=10.0), P.Hold(1.0)],
        fields_at=times,
        rtol=1e-4,
    )
    # The integrator settles under a load, so it begins with a fiftieth of it.
    load_at = lambda t: 10.0 * min(max(t, 0.02), 1.0)  # noqa: E731
    states = explicit_history(rough, load_at, None, times, 4e-3, k0=1.0, k1=3.0, R=1.0)
    for (_, u0), field in zip(states, history.dataset["u0"].values, strict=True):
        shape, wanted = field - field.mean(), u0 - u0.mean()
        assert np.abs(shape - wanted).max() < 0.01 * np.abs(wanted).max()


@pytest.mark.parametrize("used", ["held", "relaxed", "pressed again"])
def test_no_load_is_for_ramps_alone(rough, used):
    solid = asp.solids.half_space(modulus=10.0, branches=[(0.3, 0.5)])
    touching = asp.press(rough, solid, load=0.0)
    with refuses(name="load" if used == "pressed again" else "hold"):
        if used == "held":
            asp.age(touching, [1.0])
        elif used == "relaxed":
            asp.relax(touching)
        else:
            asp.press(asp.press(rough, solid, load=1.0), load=0.0)
