"""Random bodies pressed, aged and relaxed: an equilibrium by an operator of its own, or one clear line."""

import math
from dataclasses import dataclass
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


def law(draw: Draw, stress: float, speed: float) -> asp.solids.LocalCreep:
    """A law of creep that moves contacts under stresses like this one."""
    kind = draw.one([asp.solids.Eyring, asp.solids.Garofalo, asp.solids.Norton])
    numbers = [speed * draw.decades(-2, 1), stress * draw.decades(-0.5, 1), draw.one([1.0, 2.0, 3.5, 5.0])]
    made: asp.solids.LocalCreep = kind(*numbers[: 2 if kind is asp.solids.Eyring else 3])
    return made


@dataclass
class Bodies:
    """A surface, a solid that is as stiff as it is rough, and a load, in any units of length and time."""

    rough: Any
    solid: asp.solids.Solid
    place: dict[str, Any]
    load: float
    length: float
    time: float
    hangs: bool

    @classmethod
    def drawn(cls, draw: Draw) -> "Bodies":
        on_sites = draw.chance(0.45)
        shape = (draw.between(4, 20), draw.between(4, 20)) if draw.chance(0.85) else (draw.between(4, 60),)
        rough = draw.rng.normal(size=shape) + draw.one([0.0, 0.0, 1.0, -95.0, 95.0])
        length, force, time = (draw.one([1.0, 1.0, draw.decades(-9, 3)]) for _ in range(3))
        draw.say(f"{shape} + {rough.mean():.3g}, units {length:g} {force:g} {time:g}")
        hard, creeps = draw.chance(0.3), draw.chance(0.4)
        stiffness = force / (length if on_sites else length ** len(shape))
        borne = draw.decades(-0.7, 0.3) * (force if on_sites else stiffness)
        numbers: dict[str, Any] = {"hardness": borne * draw.decades(0.1, 1.3)} if hard else {}
        if creeps:
            numbers["creep"] = law(draw, borne, length / time)
        if on_sites:
            springs = {"k0": draw.one([1.0, 1.0, 1.0, float(creeps)]), "k1": draw.decades(-1, 2)}
            springs = {name: value * stiffness for name, value in springs.items()}
            for name in ("R", "R_viscous"):
                springs[name] = draw.one([draw.decades(-2, 1), 0.0]) / stiffness / time
            solid, sides, hangs = asp.solids.spring_lattice(**springs, **numbers), (), True
            edges = draw.one(["periodic", "reflecting"])
        else:
            numbers["apparatus"] = draw.one([None, math.inf])
            if not creeps:
                shares = draw.rng.random(draw.between(0, 3)) * 0.3
                numbers["branches"] = [(share, time * draw.decades(-2, 2)) for share in shares.tolist()]
            solid, hangs = (
                asp.solids.half_space(modulus=stiffness, **numbers),
                numbers["apparatus"] is not None,
            )
            sides = tuple(length * draw.decades(-0.3, 0.3) for _ in shape)
            edges = draw.one(["periodic", "reflecting", "free"][: 1 + len(shape)])
        nominal = rough.size * float(np.prod(sides))
        place = {"spacing": sides, "edges": edges}
        draw.say(f"{solid} {place}")
        load = borne * nominal * draw.decades(-2.5, -0.2)
        return cls(rough * length, solid, place, load, length, time, hangs)


def coming(draw: Draw, bodies: Bodies) -> tuple[Contact, list[Any], list[float]]:
    """Bodies that do not bear anything, what puts a load on, and times."""
    lasting, top = bodies.time * draw.decades(-2, 2), float(bodies.rough.max())
    legs: list[Any] = [asp.protocols.Ramp(lasting, load=bodies.load)]
    start = {"load": 0.0}
    if bodies.hangs and draw.chance(0.3):
        legs = [asp.protocols.Ramp(lasting, separation=top - bodies.length * draw.decades(-2, 0))]
        start = draw.one([start, {"separation": top + bodies.length * draw.decades(-2, 0)}])
    elif draw.chance(0.3):
        legs.append(asp.protocols.Ramp(lasting, load=bodies.load * draw.decades(-2, 0)))
    hold = draw.one([None, None, "separation" if bodies.hangs else None])
    legs.append(asp.protocols.Hold(bodies.time * draw.decades(-1, 2), hold=hold))
    times = lasting * 10.0 ** np.sort(draw.rng.uniform(-2, 0, size=draw.between(1, 3)))
    draw.say(f"{start} {legs} {times.tolist()}")
    return pressed_on(bodies.rough, bodies.solid, **bodies.place, **start), legs, times.tolist()


def test_loads_that_come_from_nothing():
    """In any units, with shear beside: none is refused."""

    def attempt(draw: Draw) -> None:
        bodies = Bodies.drawn(draw)
        contact, legs, times = coming(draw, bodies)
        carried, shear, friction = None, bodies.load * draw.decades(-3, 0), draw.decades(-1, 0.3)
        if bodies.solid.kind == "half_space" and contact.heights.ndim == 2 and draw.chance(0.5):
            carried = asp.Carried(shear=shear, friction_coefficient=friction)
        draw.say(carried)
        history = asp.age(contact, times, protocol=legs, rtol=draw.one([1e-2, 0.1]), carried=carried)
        series, final = history.dataset, history.final
        assert (series["residual"] <= 1e-8).all()
        assert np.isfinite(series[["area", "load", "separation", "energy"]].to_array()).all()
        assert (final.u >= final.heights).all()
        assert (final.force[~final.in_contact] == 0).all()
        if final.control.load_controlled:
            assert abs(final.load / legs[-2].load - 1) <= 1e-9
        if carried is not None:
            sticks = shear < friction * series["load"]
            assert ((series["stick_fraction"] > 0) == sticks).all()

    fuzz("loads that come from nothing", 20, attempt)


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
