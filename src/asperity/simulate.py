"""The verbs: press two bodies together, let the contact age, slide it, pull it apart, relax it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from pathlib import Path
from typing import Any, Literal, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from asperity.aging.ages import Ages, check_strength
from asperity.aging.frames import Frame
from asperity.aging.legs import LegMidway, check_slides, follow
from asperity.aging.limit import relaxed
from asperity.aging.march import DEFAULT_RTOL, check_rtol
from asperity.base import checks, units
from asperity.base.calls import answered as _answered
from asperity.base.calls import remark
from asperity.carried import Carried
from asperity.carried.record import quantities
from asperity.contact.adhesive import zone_remark
from asperity.contact.bodies import bodies_of, control_by
from asperity.contact.choice import chosen_solver
from asperity.contact.contact import WHERE_FROM, Contact, control_of
from asperity.contact.controls import Hold, Load, Separation
from asperity.contact.instantaneous import check_load, first_contact, pressed_anew, slid
from asperity.contact.problem import ContactSolver
from asperity.contact.pulling import approach, refine, retreat
from asperity.contact.remarks import remarks_on_bodies, remarks_on_contacts, resolution_of
from asperity.errors import InputError
from asperity.lattice import Field
from asperity.progress import Checkpoint, listener
from asperity.protocols import Hold as HoldLeg
from asperity.protocols import Leg
from asperity.protocols.histories import check_start
from asperity.protocols.legs import check_edges, checked_direction, legs_of, sites_along
from asperity.protocols.schedule import Schedule
from asperity.results.checkpoint import Keeper, Place, fingerprint_of
from asperity.results.dataset import Moment, Snapshot, dataset_of, moment_of, snapshot_of
from asperity.results.history import History
from asperity.results.pulling import Pull
from asperity.results.tabor import with_friction
from asperity.solids import Solid
from asperity.surfaces import Surface

Several = Sequence[float] | Sequence[str] | NDArray[np.float64]
"""Several loads, pressures or separations."""


@overload
def press(
    heights: ArrayLike | Contact,
    solid: Solid | None = None,
    *,
    load: float | str | None = None,
    pressure: float | str | None = None,
    separation: float | str | None = None,
    start: Contact | None = None,
    solver: ContactSolver | None = None,
) -> Contact: ...


@overload
def press(
    heights: ArrayLike | Contact,
    solid: Solid | None = None,
    *,
    load: Several | None = None,
    pressure: Several | None = None,
    separation: Several | None = None,
    start: Contact | None = None,
    solver: ContactSolver | None = None,
) -> list[Contact]: ...


def press(
    heights: ArrayLike | Contact,
    solid: Solid | None = None,
    *,
    load: float | str | Several | None = None,
    pressure: float | str | Several | None = None,
    separation: float | str | Several | None = None,
    start: Contact | None = None,
    solver: ContactSolver | None = None,
) -> Contact | list[Contact]:
    """Press a flat elastic solid onto a rigid rough surface, or press an aged contact anew.

    Parameters
    ----------
    heights
        Heights of the rough surface, shape ``(n,)`` or ``(n, m)``, any unit of length; periodic. Or a
        contact, such as the ``final`` of a history: its load or separation changes instantly, without creep.
    solid
        The elastic solid, for example `asperity.solids.spring_lattice`. A contact brings its own.
    load
        Normal load, the sum of all contact forces: stiffness times height; on a continuum under a surface
        with units in newtons, or a text with a unit, as for the next two: ``"5 mN"``. At 0 the highest sites
        just touch: from there a `asperity.protocols.Ramp` puts a load on. Of bodies that stick it may be any
        number, below 0 where it pulls.
    pressure
        Instead of the load: load over nominal area. On a solid that is defined on sites, load per site.
    separation
        Instead of the load: position of the rigid body, in the unit of the heights; on the lattice of
        springs, the mean of u0. Of one of these three also several: a list, a tuple or an array, shape
        ``(n,)``.
    start
        A contact to start the search from, such as that of a slightly smaller load; it saves time.
    solver
        How to solve: by default `Multigrid` for the lattice of springs in two dimensions, and
        `ActiveSet` for any other solid.

    Returns
    -------
    Contact
        Or of several loads, pressures or separations a list of contacts, in their order. Each is pressed from
        `start` or from nothing.

    Raises
    ------
    InputError
        The heights, the load, the separation or the solid cannot be used; the message says why.
    ConvergenceError
        The solver did not reach its tolerance.
    PulledOff
        The bodies stick, but do not bear the load; the error has the last one that they bore.

    Notes
    -----
    u minimizes Jagla's energy, Eq. (e), under u >= heights, with u0 flat, or of the shape it has.
    """
    prescribed = {"load": load, "pressure": pressure, "separation": separation}
    name = checks.one_of("load=800.0", **prescribed)

    def at(number: object) -> Contact:
        if isinstance(heights, Contact):
            control = control_by(heights, name, number)
            if start is not None or solid not in (None, heights.solid):
                raise InputError(
                    "heights",
                    expected="heights, where a solid or a start is given",
                    got="a contact, which has its own solid and shape",
                    advice="asperity.press(contact, load=...)",
                )
            return pressed_anew(heights, control, solver)
        return pressed(heights, solid, start=start, solver=solver, **{name: number})

    value: Any = prescribed[name]
    several = isinstance(value, list | tuple) or getattr(value, "ndim", 0) == 1
    contacts = [at(item) for item in (value if several else [value])]
    if isinstance(heights, Surface) and contacts:
        states = [resolution_of(one, heights, f"under {one.load:.3g}{' N' * one.si}") for one in contacts]
        found = remarks_on_contacts(heights, contacts[0].solid, states, "contacts")
        for text in (*remarks_on_bodies(heights, contacts[0].solid), zone_remark(contacts[0]), *found):
            remark(text)
    return contacts if several else contacts[0]


def pressed(
    heights: ArrayLike,
    solid: Solid | None,
    *,
    start: Contact | None = None,
    solver: ContactSolver | None = None,
    **held: Any,
) -> Contact:
    """`press` without remarks, for histories, which have their own."""
    body = checks.instance("solid", solid, Solid, "asperity.solids.spring_lattice(k0=1.0, k1=3.0)")
    bodies = bodies_of(heights, body)
    dimensions = bodies.lattice.dimension
    units.check_units(dict(body.parameters), si=bodies.si, dimensions=dimensions, name="apparatus")
    name = checks.one_of("load=800.0", **held)
    return first_contact(bodies, control_by(bodies, name, held[name]), start=start, solver=solver)


def age(
    contact: Contact,
    times: ArrayLike,
    *,
    protocol: Sequence[Leg] | Leg | None = None,
    hold: Hold | None = None,
    rtol: float = DEFAULT_RTOL,
    fields_at: ArrayLike = (),
    progress: Callable[[Frame], None] | bool | None = None,
    checkpoint: str | Path | Checkpoint | None = None,
    carried: Carried | None = None,
    solver: ContactSolver | None = None,
    exact: bool = True,
) -> History:
    r"""Let a contact creep under its load or at its separation, and record it at given times.

    Parameters
    ----------
    contact
        Where to start: from `press`, or the ``final`` of an earlier history.
    times
        Strictly increasing hold times >= 0, shape ``(n,)``, since this call. Their unit is
        1 / (stiffness * R); for a contact with units s, or texts such as ``["1 s", "10 min"]``.
    protocol
        The history of the load or the separation: a list of legs of `asperity.protocols`, followed to its
        end. All switches between legs are recorded, too; a step just before and just after. By default
        nothing changes up to the last time.
    hold
        Constant quantity without a protocol: ``"load"``, ``"separation"`` (of the rigid body) or ``"area"``;
        by default the load or the separation at which the contact was pressed.
    rtol
        Relative tolerance: the error of u0, rms over the sites, stays at every recorded time below
        ``rtol`` times the largest deformation so far (the rms of u about its mean; or that of u - u0,
        if larger, at a held separation with viscous creep); measured, not proved.
    fields_at
        Strictly increasing times >= 0, not necessarily among ``times``, at which to keep u, u0, in_contact
        and forces (continua: pressures), and to count and link patches.
    progress
        True for a bar, in notebooks and on terminals; or a function that is called with each `Frame`.
    checkpoint
        File in which the run keeps its place, every ten seconds or as `Checkpoint` says. If it exists, the
        run resumes there, with an identical result. Remove it when the results are safe. The repr of a solver
        of your own must contain all its parameters.
    carried
        Carried quantities to record at each time: stiffness, resistances, sticking share, each of which costs
        about one press a time; and friction of a shear strength that may age.
    solver
        Contact solver, by default that of `asperity.press`. Local laws of creep have their own.
    exact
        Whether to use the exact contact of a separable solid (`Solid.separable`) as long as the load has
        never fallen. The dataset records its use.

    Returns
    -------
    History
        If adhering bodies part, it ends there, and its dataset has the attribute ``pulled_off``, the time.

    Raises
    ------
    InputError
        Times, tolerance or ``hold`` are wrong, or the checkpoint is of another run.
    ConvergenceError
        A contact problem was not solved, or a time step became too small.

    Notes
    -----
    Integrates Jagla's Eq. (dosrs), du0/dt = M C (u - u0), in adaptive steps of `asperity.aging.tr_bdf2`; for
    the exact contact see `asperity.aging.separable`.
    """
    tolerance = check_rtol(rtol)
    protocol = [protocol] if isinstance(protocol, Leg) else protocol
    asked_times, moments = units.numbers("times", times, "s"), units.numbers("fields_at", fields_at, "s")
    recorded = checks.times("times", asked_times)
    wanted = checks.times("fields_at", moments, at_least=0)
    recorded, kept = recorded[recorded > 0], wanted[wanted > 0]
    stops = np.union1d(recorded, kept)
    schedule = _schedule(contact, protocol, hold, stops)
    remark(zone_remark(contact, schedule.switches[-1] if protocol else float(max(stops, default=0.0))))
    units.check_units(asked_times, moments, si=contact.si)
    method = chosen_solver(solver, contact.system())
    if carried is not None:
        quantities(checks.instance("carried", carried, Carried, "asperity.Carried(resistivity=...)"), contact)
    entries = {*recorded.tolist(), *(schedule.switches if protocol else (0.0,))}
    rows: list[Moment] = []
    snapshots: list[Snapshot] = []
    fields, resume = np.append(kept, 0.0) if 0 in wanted else kept, None
    run = contact, schedule, recorded, fields, tolerance, method, exact, carried
    keeper = Keeper(checkpoint, b"" if checkpoint is None else fingerprint_of(*run))
    if (found := keeper.read()) is not None:
        place = Place.unpacked(*found)
        resume, rows, snapshots = place.midway, place.rows, place.snapshots

    def keep_place(midway: Callable[[], LegMidway]) -> None:
        if keeper.is_due():
            keeper.write(*Place(midway(), rows, snapshots).packed())

    final, parted = contact, False
    with listener(progress) as shown:
        shown.stage("aging", times=stops.tolist())
        for frame in follow(
            contact,
            schedule,
            stops,
            rtol=tolerance,
            solver=method,
            exact=exact,
            resume=resume,
            after_step=keep_place,
            ages=_ages_of(carried, contact, schedule),
        ):
            shown.reached(frame)
            final, parted = frame.contact, frame.parted
            of_its_time = not frame.passing
            if of_its_time and frame.time in wanted and not parted:
                snapshots.append(snapshot_of(frame, carried))
            is_entry = frame.at_a_shift or (of_its_time and frame.time in entries)
            if (frame.time > rows[-1]["time"]) if parted else is_entry:
                rows.append(moment_of(frame, slides=schedule.slides, carried=carried))
    control = control_of(contact, hold) if protocol is None else contact.control
    legs = protocol, schedule.switches, hold == "area"
    dataset = dataset_of(contact, control, *legs, rows, snapshots, rtol=tolerance)
    if carried is not None and carried.strength is not None:
        dataset = with_friction(dataset, carried.strength, np.array([row.get("grown", 0.0) for row in rows]))
    if parted:
        dataset.attrs["pulled_off"] = rows[-1]["time"]
        when = f"{rows[-1]['time']:g}{' s' * contact.si}"
        remark(f"the bodies were pulled off each other at time {when}, where the history ends")
    if "stick_fraction" in dataset and not (sticks := dataset["stick_fraction"].values > 0).all():
        slides = f"the bodies slide at {np.count_nonzero(~sticks)} of {sticks.size} recorded times"
        remark(f"{slides}: friction times load is not above the shear force")
    return History(dataset, final)


def _ages_of(carried: Carried | None, contact: Contact, schedule: Schedule) -> Ages | None:
    """Ages of the sites, for a strength that ages; refuses a strength before hours have passed."""
    if carried is None or (strength := carried.strength) is None:
        return None
    units.check_units(vars(strength), si=contact.si)
    strength.at([leg.speed for leg in schedule.legs if leg.speed] or [0.0])
    if not strength.ages:
        return None
    check_strength(strength, schedule, contact.lattice)
    return Ages(strength, contact)


def _schedule(contact: Contact, protocol: Sequence[Leg] | None, hold: Hold | None, times: Field) -> Schedule:
    """Schedule of a protocol, or of one hold up to the last time, that this contact can follow."""
    if protocol is None:
        control_of(contact, hold)
        schedule = Schedule.of([HoldLeg(float(times[-1]), hold)] if times.size else [], times)
    elif hold is not None:
        advice = f"Hold(..., hold={hold!r})"
        raise InputError("hold", expected="none beside a protocol", got=repr(hold), advice=advice)
    else:
        legs = list(legs_of(protocol))
        checks.instance("contact", contact, Contact, WHERE_FROM)
        check_start(protocol, contact)
        dimensions = contact.lattice.dimension
        units.check_units([vars(leg) for leg in legs], si=contact.si, dimensions=dimensions, name="protocol")
        schedule = Schedule.of(legs, times)
        check_slides(legs, contact.lattice, contact.solid)
        for leg in legs:
            if (load := leg.load_on(contact.nominal_area)) is not None:
                check_load(contact.system(Load(load)))
    if schedule.holds_separation:
        contact.system(Separation(contact.separation))
    return schedule


def slide(
    contact: Contact,
    shift: float | Sequence[float] | None = None,
    *,
    distance: float | str | None = None,
    direction: str | tuple[int, ...] = "x",
    solver: ContactSolver | None = None,
) -> Contact:
    """Slide the rough surface under the elastic body, instantly; the crept shape stays with the body.

    Parameters
    ----------
    contact
        A contact on a surface with periodic edges.
    shift
        Sites along each axis by which the heights move, as by ``numpy.roll``; one number is along the last
        axis. Whole numbers are exact. Fractions interpolate the heights, see Notes.
    distance
        Instead of the shift: a length > 0, in the unit of the distance between sites, or a text with a unit:
        ``"2 um"``.
    direction
        Direction of the distance: ``"x"``, ``"-x"``, ``"y"``, ``"-y"``, or sites along the axes, ``(1, 1)``.
    solver
        As in `press`.

    Returns
    -------
    Contact
        Above the moved heights, under the same load or at the same separation.

    Raises
    ------
    InputError
        The edges of the surface are not periodic, or shift, distance or direction are wrong.
    ConvergenceError
        The solver did not reach its tolerance.

    Notes
    -----
    Between sites heights are interpolated by a trigonometric polynomial, exact for a surface without waves
    near the lattice spacing. A surface that is rough at the scale of a site gets other summits, and so
    another contact: slide it by whole sites.
    """
    checks.instance("contact", contact, Contact, WHERE_FROM)
    check_edges(contact.lattice)
    lattice = contact.lattice
    if checks.one_of("shift=(0, 1)", shift=shift, distance=distance) == "distance":
        along = sites_along(checked_direction(direction), lattice.dimension)
        length = units.converted("distance", distance, "m", si=contact.si)
        length = checks.number("distance", length, above=0)
        sites = [n * length / lattice.length_of(along) for n in along]
    else:
        expected = "one finite number of sites, or one for each axis"
        shifts = np.atleast_1d(checks.floats("shift", shift, expected=expected, advice="shift=(0, 1)"))
        if shifts.ndim != 1 or shifts.size not in (1, lattice.dimension) or not np.isfinite(shifts).all():
            raise InputError("shift", expected=expected, got=checks.shown(shift), advice="shift=(0, 1)")
        sites = shifts.tolist()
        sites = [0.0] * (lattice.dimension - shifts.size) + sites
    by = [Fraction(n) % size for n, size in zip(sites, lattice.shape, strict=True)]
    if not any(by):
        return contact
    return slid(contact, lattice.shifted(contact.heights, by), by, solver)


def pull(
    contact: Contact,
    *,
    through: Literal["load", "separation"] | None = None,
    steps: int = 20,
    solver: ContactSolver | None = None,
) -> Pull:
    """Pull adhering bodies apart, instantly, to the last contact, and let them approach again.

    The crept shape stays. Contacts jump and lose energy, so the approach differs from the retreat.

    Parameters
    ----------
    contact
        Where to start: from `press`, or the ``final`` of a history, of a solid with adhesion.
    through
        Prescribed quantity: the load, down to the largest tension, or the separation, until the bodies are
        apart. By default the separation, if the solid allows it.
    steps
        Approximate number of states while the load changes by the first attraction, or by the first load if
        larger; at least 2. States are added for the pull-off force, to 0.1 %, and by separation for the
        energy lost, to 1 %; see docs/adhesion.md.
    solver
        As in `press`.

    Returns
    -------
    Pull
        ``curve`` (a Dataset), ``force`` (the pull-off force), ``energy_lost``, ``last`` (a contact).

    Raises
    ------
    InputError
        No adhesion, no contact, or a separation that cannot be prescribed.
    ConvergenceError
        The solver did not reach its tolerance.
    """
    law = checks.instance("contact", contact, Contact, WHERE_FROM).solid.adhesion
    if law is None or not contact.area:
        expected, got = "bodies that stick, in contact", "no contact" if law else "a solid without adhesion"
        raise InputError(
            "contact", expected=expected, got=got, advice="half_space(..., adhesion=Dugdale(...))"
        )
    if through not in (None, "load", "separation"):
        raise InputError("through", expected="'load' or 'separation'", got=repr(through))
    steps = checks.integer("steps", steps, least=2)
    if through == "separation":
        contact.system(Separation(contact.separation))
    kind = Load if through == "load" or not contact.system().body.stiffness else Separation
    attracting = contact.lattice.cell * float(law.traction(contact.gap).sum())
    change = max(attracting, abs(contact.load)) / steps
    back = retreat(contact, kind, change, solver)
    forth = approach(back[-1], contact, kind, change, solver)
    if kind is Separation:
        refine(forth, back, solver)
    return Pull.of(forth, back)


def relax(contact: Contact, *, hold: Hold | None = None, solver: ContactSolver | None = None) -> Contact:
    """Find the final state of creep, without time steps.

    Parameters
    ----------
    contact
        Where creep starts.
    hold
        Constant quantity, ``"load"`` or ``"separation"`` (of the rigid body); by default that at which the
        contact was pressed.
    solver
        Contact solver, by default that of `asperity.press`.

    Returns
    -------
    Contact
        The limit; with R_viscous > 0 under a load only of the shape, as the rigid body has none.

    Raises
    ------
    InputError
        The limit depends on the history: k0 = 0 and a load that vanishes before full contact.
    ConvergenceError
        The solver did not reach its tolerance.
    """
    if hold == "area":
        raise InputError("hold", expected="'load' or 'separation' for the limit", got=repr(hold))
    return relaxed(contact, control_of(contact, hold), solver)


__all__ = ["age", "press", "pull", "relax", "slide"]
__dir__ = _answered(globals())
