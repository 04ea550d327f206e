"""Reflecting edges give what the surface joined to its mirror images gives, at a quarter of the sites."""

import numpy as np
import pytest

import asperity as asp
from tests.continua import pressed
from tests.surfaces import correlated

P = asp.protocols
BRANCHES = [(0.3, 0.1), (0.5, 3.0)]
SOLIDS = {
    "half-space": asp.solids.half_space(modulus=2.0, branches=BRANCHES),
    "diffusion": asp.solids.half_space(modulus=2.0, flow=(0.5, 1.0)),
    "layer": asp.solids.layer(modulus=2.0, poisson=0.4, thickness=3.0, branches=BRANCHES),
    "springs": asp.solids.spring_lattice(k0=1.0, k1=3.0, R_viscous=0.1),
}


def mirrored(field):
    """The field joined to its mirror images along each of the last axes."""
    for axis in range(-min(field.ndim, 2), 0):
        field = np.concatenate([field, np.flip(field, axis)], axis=axis)
    return field


@pytest.mark.parametrize("shape", [(20, 15), (48,)], ids=["plane", "line"])
@pytest.mark.parametrize("name", SOLIDS)
def test_reflecting_edges_are_a_periodic_surface_twice_as_long(name, shape):
    heights = np.random.default_rng(4).normal(size=shape) if len(shape) == 1 else correlated(20, 0.8)[:, :15]
    spacing = (1.0,) * len(shape) if name == "springs" else (1.5, 0.5)[: len(shape)]
    load, times = 0.1 * heights.size, np.array([0.5, 1.0, 2.0])
    copies = 2 ** len(shape)
    one = pressed(heights, SOLIDS[name], load=load, spacing=spacing, edges="reflecting")
    all_ = pressed(mirrored(heights), SOLIDS[name], load=copies * load, spacing=spacing)
    assert 0 < one.area < heights.size
    histories = []
    for contact, unit in ((one, load), (all_, copies * load)):
        protocol = [P.Hold(1.0), P.Step(load=0.4 * unit), P.Hold(0.5), P.Ramp(0.5, load=1.5 * unit)]
        histories.append(asp.age(contact, times, protocol=protocol, rtol=2e-4))
    spread = one.u.std()
    for state, whole, allowed in (
        (one, all_, 1e-7 * spread),
        (*(history.final for history in histories), 5e-4 * spread),
    ):
        np.testing.assert_array_equal(mirrored(state.in_contact), whole.in_contact)
        np.testing.assert_allclose(mirrored(state.u), whole.u, atol=allowed)
        assert copies * state.energy == pytest.approx(whole.energy, rel=10 * allowed / spread)
        assert copies * state.load == pytest.approx(whole.load, rel=1e-8)
        assert state.separation == pytest.approx(whole.separation, abs=allowed)
        for anchor, other in zip(state.anchors, whole.anchors, strict=True):
            difference = mirrored(anchor) - other
            assert (difference - difference.mean()).std() <= 2 * allowed
        if len(shape) == 2:
            assert copies * state.contact_area_corrected == pytest.approx(whole.contact_area_corrected)
        assert copies * state.normal_stiffness == pytest.approx(whole.normal_stiffness, rel=1e-6)
    np.testing.assert_array_equal(
        copies * histories[0].dataset["area"].values, histories[1].dataset["area"].values
    )
    np.testing.assert_allclose(mirrored(asp.relax(one).u), asp.relax(all_).u, atol=1e-6 * spread)
