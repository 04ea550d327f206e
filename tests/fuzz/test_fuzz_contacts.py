"""Random bodies pressed, aged and relaxed: an equilibrium by an operator of its own, or one clear line."""

import math
from typing import Any

import numpy as np

import asperity as asp
from asperity.contact import Contact
from asperity.errors import AsperityError
from tests.continua import pressed as pressed_on
from tests.fuzz.fuzzing import Draw, fuzz, tried
from tests.independent import assert_equilibrium

LAYOUTS = [
    np.asfortranarray,
    np.ascontiguousarray,
    lambda field: np.repeat(field, 2, axis=0)[::2],
    lambda field: field[::-1],
    lambda field: field.tolist(),
    lambda field: field.astype(np.float32),
    lambda field: field.astype(">f8"),
    lambda field: field.astype(np.longdouble),
]


def heights(draw: Draw, longest: int = 40) -> Any:
    """A small surface or profile, of any kind, offset, scale, type and layout."""
    shape: tuple[int, ...] = (draw.between(4, longest), draw.between(4, longest))
    if draw.chance(0.2):
        shape = draw.one([(1,), (2,), (draw.between(4, 300),), (1, 5), (2, 2), (draw.between(1, 40), 1)])
    rough = draw.rng.normal(size=shape)
    kind = draw.one(["white", "smooth", "stepped", "spike", "flat", "doubled", "wave"])
    if kind == "smooth":
        axes = tuple(range(len(shape)))
        waves = sum(q**2 for q in np.meshgrid(*map(np.fft.fftfreq, shape), indexing="ij"))
        rough = np.fft.ifftn(np.fft.fftn(rough, axes=axes) / (1e-3 + waves), axes=axes).real
    elif kind == "stepped":
        rough = np.round(rough)
    elif kind == "spike":
        rough = rough * draw.one([0.0, 1e-12, 1e-3])
        rough.flat[draw.between(0, rough.size - 1)] = 5.0
    elif kind == "flat":
        rough = np.full(shape, draw.one([0.0, 1.0, -3.0]))
    elif kind == "doubled":
        rough = np.concatenate([rough, rough], axis=-1)
    elif kind == "wave":
        rough = np.cos(np.linspace(0, 6 * np.pi, rough.size)).reshape(shape)
    scale, offset = draw.one([1.0, 1.0, draw.decades(-30, 30)]), draw.one([0.0, 0.0, 0.0, 1.0, -1e3, 1e9])
    draw.say(f"{kind} {rough.shape} x {scale:g} + {offset:g} x")
    rough = scale * (rough + offset)
    return draw.one(LAYOUTS)(rough) if draw.chance(0.3) and 1e-25 < scale < 1e25 else rough


def springs(draw: Draw) -> dict[str, Any]:
    """Spring constants, of which k1 is not zero."""
    near = draw.chance(0.5)
    k0, k1, R, viscous = (draw.decades(*((-2, 2) if near else (-8, 8))) for _ in range(4))
    unit = 1.0 if near else draw.one([1.0, 1.0, 1e-20, 1e20])
    k0, R, viscous = draw.one([k0, k0, k0, k0, 0.0]), draw.one([R, R, 0.0]), draw.one([viscous, 0.0])
    return {"k0": k0 * unit, "k1": k1 * unit, "R": R, "R_viscous": viscous}


def control(draw: Draw, rough: Any, stiffness: float) -> dict[str, Any]:
    """A load or a separation, from almost nothing to full contact and beyond."""
    rough = np.asarray(rough, dtype=float)
    spread = float(np.ptp(rough)) or max(abs(float(rough.max())), 1.0)
    if draw.chance(0.65):
        # A load that leaves any contact with the numbers that it needs lies in the bounds of numbers.
        return {"load": float(np.clip(draw.decades(-6, 3) * stiffness * spread * rough.size, 1e-90, 1e90))}
    depth = draw.one([-1e-6, -0.03, -0.3, -1.0, -3.0, 0.0, 0.5, -1e3])
    return {"separation": float(rough.max()) + spread * depth}


def judged(contact: Contact, k: dict[str, float], load: float | None = None) -> None:
    """An equilibrium of the spring lattice, as another operator sees it; and the load that was asked for."""
    proof = assert_equilibrium(contact, k0=k["k0"], k1=k["k1"], load_may_vanish=True)
    if load is not None:
        # The heights are rounded where they are, far from zero perhaps, and the stiffest spring feels it.
        rounding = (
            np.spacing(np.abs([contact.u, contact.u0]).max())
            * (4 * contact.u.ndim * k["k0"] + k["k1"])
            * contact.u.size
        )
        assert abs(proof.load - load) <= 1e-9 * load + rounding
        assert abs(contact.load - load) <= 1e-9 * load + rounding


def test_springs():
    def attempt(draw: Draw) -> None:
        rough = heights(draw)
        k = springs(draw)
        held = control(draw, rough, k["k0"] + k["k1"])
        draw.say(f"{k} {held}")
        contact = tried(lambda: asp.press(rough, asp.solids.spring_lattice(**k), **held))
        draw.say(contact)
        if isinstance(contact, AsperityError):
            return
        judged(contact, k, held.get("load"))
        hold = draw.one([None, "load", "separation"])
        draw.say(f"hold {hold}")
        limit = tried(lambda: asp.relax(contact, hold=hold))
        draw.say(limit)
        if not isinstance(limit, AsperityError):
            judged(limit, k)
        if draw.chance(0.5):
            return
        unit = 1 / ((k["k0"] + k["k1"]) * (k["R"] + k["R_viscous"]) or 1.0)
        times = unit * 10.0 ** np.sort(draw.rng.uniform(-4, draw.one([2, 8, 20]), size=draw.between(1, 4)))
        keep, rtol = [0.0, times[-1]] if draw.chance(0.3) else (), draw.one([1e-1, 1e-2])
        draw.say(f"times {times.tolist()}")
        history = tried(lambda: asp.age(contact, times, hold=hold, rtol=rtol, fields_at=keep))
        draw.say(history)
        if not isinstance(history, AsperityError):
            series = history.dataset[["area", "load", "separation", "energy", "residual"]]
            assert np.isfinite(series.to_array()).all()
            judged(history.final, k)

    fuzz("springs", 60, attempt)


def relaxing(draw: Draw) -> list[tuple[float, float]]:
    """Branches: any, none, or those of a power law."""
    if draw.chance(0.2):
        first, accuracy = draw.decades(-4, 0), draw.one([0.1, 0.01, 1e-3])
        law = {"modulus": 1.0, "exponent": draw.rng.uniform(0.02, 0.98), "accuracy": accuracy}
        times = {"time": 1.0, "first": first, "last": first * draw.decades(0.5, 8)}
        return list(asp.relaxation.power_law(**law, **times).branches)
    shares = draw.rng.random(draw.between(0, 5)) * draw.one([1.0, 1e-3])
    shares /= max(1.0, shares.sum()) * draw.one([1.0, 2.0])
    return [(share, draw.decades(-4, 4)) for share in shares.tolist()]


def continuum(draw: Draw) -> tuple[asp.solids.Solid, float]:
    """A half-space, with an apparatus or without, a layer or a film, of any branches or flow; its modulus."""
    modulus, branches = draw.decades(-6, 6), relaxing(draw)
    solid: dict[str, Any] = {"modulus": modulus, "branches": branches}
    apparatus = draw.one([None, None, math.inf, modulus * draw.decades(-2, 2)])
    kind = draw.one(
        [asp.solids.coated_half_space, asp.solids.layer, asp.solids.half_space, asp.solids.half_space]
    )
    if kind is not asp.solids.half_space:
        solid |= {"poisson": draw.one([-0.5, 0.0, 0.3, 0.5]), "thickness": draw.decades(-2, 2)}
    if kind is asp.solids.coated_half_space:
        solid |= {"base_modulus": modulus * draw.decades(-3, 3), "base_poisson": draw.one([0.0, 0.3, 0.5])}
        solid |= {"base_branches": relaxing(draw), "apparatus": apparatus}
    elif kind is asp.solids.layer:
        solid |= {"bonded": draw.chance(0.5)}
    else:
        flow = (draw.decades(-3, 3), draw.one([-1.0, 0.0, 1.0, 2.0])) if draw.chance(0.2) else None
        solid |= {"flow": flow, "apparatus": apparatus, "branches": [] if flow else branches}
    draw.say(solid)
    return kind(**solid), modulus


def test_contacts_of_continua():
    def attempt(draw: Draw) -> None:
        rough = np.asarray(heights(draw, 20), dtype=float)
        found = tried(lambda: continuum(draw))
        draw.say(found)
        if isinstance(found, AsperityError):  # as of a film that keeps no stiffness
            return
        solid, modulus = found
        spacing = tuple(draw.decades(-1, 1) for _ in rough.shape)
        held = control(draw, rough, modulus * float(np.prod(spacing)) ** 0.5)
        edges = draw.one(["periodic", "reflecting"])
        draw.say(f"{solid} {spacing} {edges} {held}")
        contact = tried(lambda: pressed_on(rough, solid, spacing=spacing, edges=edges, **held))
        draw.say(contact)
        if isinstance(contact, AsperityError):
            return
        exact = draw.chance(0.5)
        for one in (
            contact,
            tried(lambda: asp.age(contact, [0.1, 10.0], rtol=0.1, exact=exact)),
            tried(lambda: asp.relax(contact)),
            tried(lambda: asp.press(contact, load=2 * contact.load or 1.0)),
        ):
            draw.say(one)
            state = one.final if isinstance(one, asp.History) else one
            if isinstance(state, Contact):
                np.testing.assert_array_equal(state.in_contact, state.u == state.heights)
                assert (state.u >= state.heights).all()
                assert (state.force[~state.in_contact] == 0).all()
                assert (state.force >= 0).all()
                assert state.residual <= 1e-8
                assert state.normal_stiffness >= 0
                assert state.contact_area_corrected <= state.contact_area

    fuzz("contacts of continua", 40, attempt)
