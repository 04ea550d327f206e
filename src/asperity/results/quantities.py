"""Every number that is recorded: its name, symbol and unit, where it stands, of what, and in which tables.

`QUANTITIES` is the only list of them: variables of the Dataset and their attributes, columns of tables, the
page to explore, campaigns, labels of axes and the reference are read from it.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from enum import Flag, auto
from functools import partial
from typing import TYPE_CHECKING, Literal

from asperity.contact import Contact
from asperity.contact.bodies import Bodies

if TYPE_CHECKING:
    import xarray as xr

Home = Literal["coordinate", "series", "field", "contact", "map"]
Of = Literal["all", "sites", "continua", "yielding", "sliding", "friction", "carried"]


class Table(Flag):
    """Tables in which a number may be a column."""

    RUN = auto()
    """``aging.csv``, or of maps ``patches.csv``, of a run."""
    PREDICT = auto()
    """``history.csv`` of a prediction."""
    PAGE = auto()
    """What the page to explore shows and exports."""
    CAMPAIGN = auto()
    """The table and the ensembles of a campaign; numbers about the computation stand in its dataset alone."""


RUN, PREDICT, PAGE, CAMPAIGN = Table
_NONE = Table(0)


@dataclass(frozen=True)
class Quantity:
    """A number that is recorded."""

    name: str
    """Its name in the Dataset, and that of the attribute of `Contact` or `Frame` from which it is read."""
    dimension: str
    """A key of `units_of`, or the unit itself."""
    long_name: str
    """What it is."""
    tables: Table = _NONE
    """Where it is a column."""
    of: Of = "all"
    """Which have it: solids that are defined on ``"sites"``, ``"continua"``, those with a hardness
    (``"yielding"``), histories with ``"sliding"``, a shear strength (``"friction"``) or what `Carried`
    asks for (``"carried"``), or ``"all"``."""
    home: Home = "series"
    """``"series"``, over time; ``"field"``, over the sites at the times of the fields; ``"contact"``, a field
    that one contact has besides; ``"map"``, what is known at the times of the fields; ``"coordinate"``."""
    symbol: str = ""
    """How the paper writes it, and in which equation, as in docs/notation.md."""
    label: str = ""
    """What axes and the page call it; by default its name."""
    whole: bool = False
    """Whether it is a whole number."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "label", self.label or self.name.replace("_", " "))

    @property
    def facts(self) -> tuple[str, str]:
        """Long name and dimension."""
        return self.long_name, self.dimension


_RESULT, _SHOWN, _SOLVED, _ALL = RUN | CAMPAIGN, RUN | PAGE | CAMPAIGN, RUN | PREDICT | CAMPAIGN, ~_NONE
_field, _coordinate = partial(Quantity, home="field"), partial(Quantity, home="coordinate")
_carried = partial(Quantity, tables=_ALL, of="carried")
_of_map = partial(Quantity, home="map", tables=_RESULT)
_POSITION = "separation, the position of the body; without an apparatus and free edges, the mean of u"
_AREA = "real contact area"
_RIM = f"{_AREA}, corrected for pixel rims"
_SCALE = "mean contact force, or where the load has died out the smallest that the heights resolve"
_REJECTED = "time steps repeated with a smaller length since the previous entry"
_AT_HARDNESS = "number of sites in contact whose pressure is the hardness"
_SLID = "length that the rough surface has slid since the start"
_SLOPES = "force of the slopes of the rough surface against its motion"
_SHEARED = "friction force, shear strength times real contact area"
_COEFFICIENT = "friction coefficient, friction force over load"
_STRENGTH = "shear strength, mean over the sites in contact"
_RENEWED = "age of the sites in contact, which slip renews"
_STIFF = "normal contact stiffness, instantaneous, at fixed contacts"
_STIFF_ACROSS = "tangential contact stiffness, before anything slips"
_PULLED = "pull-off force, the largest tension if pulled apart instantly at that time"
_LOWER = "by how much the rough surface is lower where it has yielded"
_LARGEST = "size of the largest patch"
_TOUCHED = "time for which the sites in contact have touched without interruption"
_MOVED = "axis by which heights had moved when fields were kept"
_SINCE = "since the map before"

QUANTITIES: tuple[Quantity, ...] = (
    _coordinate("time", "time", "hold time", RUN | PREDICT | PAGE, symbol="t"),
    Quantity("area", "sites", _AREA, _SHOWN, symbol="A, N(t)", label="contact area", whole=True),
    Quantity("load", "force", "normal load, the sum of the contact forces", _ALL, symbol="F_N"),
    Quantity("separation", "length", "separation, the mean of u0", _SHOWN, "sites", symbol="mean u⁰"),
    Quantity("separation", "length", _POSITION, _SHOWN, "continua"),
    Quantity("energy", "energy", "elastic energy, and that of adhesion", _RESULT, symbol="E, Eq. (1)"),
    Quantity("approach", "length", "rigid approach of the bodies since the start", _SOLVED),
    Quantity("contact_fraction", "1", "real contact area over nominal area", _ALL, symbol="A / N0"),
    Quantity("residual", "1", "largest force off contact over the residual scale", RUN | PREDICT | PAGE),
    Quantity("residual_scale", "force", _SCALE, CAMPAIGN),
    Quantity("steps", "1", "time steps since the previous entry", whole=True),
    Quantity("rejected", "1", _REJECTED, whole=True),
    Quantity("iterations", "1", "iterations of the contact solver since the previous entry", whole=True),
    Quantity("contact_area", "area", _AREA, _ALL, "continua"),
    Quantity("contact_area_corrected", "area", _RIM, _ALL, "continua", label="corrected contact area"),
    Quantity("mean_gap", "length", "mean gap", _SOLVED, "continua"),
    Quantity("rms_gap", "length", "root mean square of the gap over all sites", _ALL),
    Quantity("mean_contact_pressure", "pressure", "load over real contact area", _SOLVED, "continua"),
    Quantity("largest_pressure", "pressure", "largest contact pressure", _SOLVED, "continua"),
    Quantity("yielding_area", "sites", _AT_HARDNESS, _SHOWN, "yielding", label="yielding sites", whole=True),
    Quantity("displacement", "place", _SLID, _SHOWN, "sliding"),
    Quantity("velocity", "place / time", "sliding velocity", _RESULT, "sliding", symbol="V"),
    Quantity("hysteresis_friction", "energy / place", _SLOPES, _RESULT, "sliding"),
    Quantity("hysteresis_friction_coefficient", "1", f"{_SLOPES}, over load", _SHOWN, "sliding"),
    Quantity("friction_force", "force", _SHEARED, _SOLVED, "friction", symbol="F"),
    Quantity("friction", "1", _COEFFICIENT, _SOLVED, "friction", symbol="μ"),
    Quantity("friction_by_area", "1", f"{_COEFFICIENT}, without growth with age", _RESULT, "friction"),
    Quantity("strength_mean", "pressure", _STRENGTH, _RESULT, "friction", label="mean strength"),
    Quantity("contact_age_mean", "time", f"mean {_RENEWED}", _RESULT, "friction", label="mean contact age"),
    _carried("normal_stiffness", "stiffness", _STIFF, symbol="kₙ"),
    _carried("tangential_stiffness", "stiffness", _STIFF_ACROSS, symbol="kₜ"),
    *(
        _carried(
            f"tangential_stiffness_{kind}",
            "stiffness",
            f"{_STIFF_ACROSS}, {way}",
            label=f"tangential stiffness, {way}",
        )
        for kind, way in (("soft", "softest direction"), ("stiff", "stiffest direction"))
    ),
    _carried("resistance", "ohm", "electrical resistance of the constrictions", symbol="R_c"),
    _carried("thermal_resistance", "K/W", "thermal resistance of the constrictions"),
    _carried("stick_fraction", "1", "share of the contact that sticks under shear"),
    _carried("pull_off", "force", _PULLED, label="pull-off force"),
    _coordinate("leg", "1", "leg of the history, from 0", RUN | PAGE, whole=True),
    _coordinate("heights", "length", "height of the rigid rough surface", symbol="ξ(r)"),
    _field("u", "length", "height of the elastic surface", symbol="u(r), Eq. (1)"),
    _field("u0", "length", "creeping shape of the elastic surface", symbol="u⁰(r), Eq. (1)"),
    _field("in_contact", "1", "whether the site is in contact", symbol="u = ξ"),
    _field("force", "force", "contact force of a site", of="sites", symbol="r = H u + C (u − u⁰), Eq. (2)"),
    _field("pressure", "pressure", "contact pressure", of="continua", symbol="p"),
    _field("stick", "1", "whether the site sticks under shear", of="carried"),
    _field("site_age", "time", _RENEWED, of="friction", symbol="θ"),
    _field("permanent_indentation", "length", _LOWER, of="yielding"),
    Quantity("anchors", "length", "creeping shape of the elastic surface, by branch", home="contact"),
    Quantity("force", "force", "contact force of a site", of="continua", home="contact"),
    Quantity("gap", "length", "gap between the surfaces", home="contact"),
    _of_map("patches", "1", "number of contact patches", tables=_SHOWN, whole=True),
    _of_map("mean_patch_size", "sites", "mean size of a patch", tables=_SHOWN, label="mean size of a patch"),
    _of_map(
        "median_patch_size", "sites", "median size of a patch", tables=_SHOWN, label="median size of a patch"
    ),
    _of_map("largest_patch_size", "sites", _LARGEST, tables=_SHOWN, label="largest patch", whole=True),
    _of_map("perimeter", "rim", "length of the rim of all patches; on a line, their ends"),
    _of_map("mean_patch_aspect", "1", "aspect ratio of the patch of a site in contact, mean over the sites"),
    _of_map("clustering", "1", "index of dispersion of contacts in boxes"),
    _of_map("births", "1", f"patches born {_SINCE}", whole=True),
    _of_map("deaths", "1", f"patches that died {_SINCE}", whole=True),
    _of_map("merges", "1", f"merges of patches {_SINCE}", whole=True),
    _of_map("splits", "1", f"splits of patches {_SINCE}", whole=True),
    _of_map("gained_by_expansion", "sites", f"sites gained {_SINCE} by patches with one predecessor"),
    _of_map("gained_by_coalescence", "sites", f"sites gained {_SINCE} by patches with several predecessors"),
    _of_map("gained_by_births", "sites", f"sites of patches born {_SINCE}"),
    _of_map("lost_by_shrinkage", "sites", f"sites lost {_SINCE} by patches with successors"),
    _of_map("lost_by_deaths", "sites", f"sites of patches that died {_SINCE}"),
    _of_map("mean_contact_age", "time", f"mean {_TOUCHED}"),
    _of_map("contact_age", "time", _TOUCHED),
    _of_map("contact_pressure", "pressure", "contact pressure of the sites in contact"),
    _coordinate("field_time", "time", "hold time at which fields were kept"),
    _coordinate("field_leg", "1", "leg of the history in which fields were kept, from 0", whole=True),
    _coordinate("field_shift_x", "sites", f"sites along the last {_MOVED}", of="sliding"),
    _coordinate("field_shift_y", "sites", f"sites along the first {_MOVED}", of="sliding"),
    _coordinate("branch", "1", "branch of the solid, from 0", whole=True),
    _coordinate("quantile", "1", "share of the sites in contact that have at most the value"),
    _coordinate("x", "place", "site index along the last axis", of="sites"),
    _coordinate("x", "place", "x, along the rows", of="continua"),
    _coordinate("y", "place", "site index along the first axis", of="sites"),
    _coordinate("y", "place", "y, from row to row", of="continua"),
)
"""In the order of the columns of tables."""


def select(*homes: Home, of: Collection[str] = (), table: Table = _NONE) -> dict[str, Quantity]:
    """Quantities by name, in order: of all homes or some, of all or of some solids, of all tables or one.

    Of two rows of one name, one for solids that are defined on sites and one for continua, the later counts.
    """
    return {
        row.name: row
        for row in QUANTITIES
        if row.home in (homes or (row.home,)) and row.of in (of or (row.of,)) and table in row.tables
    }


def areas_first(quantities: Mapping[str, Quantity]) -> list[str]:
    """Their names in the order of tables that continua alone have: time and areas, then the others."""
    return sorted(quantities, key=lambda name: (name != "time", quantities[name].dimension != "area"))


def had_by(contact: Contact, *homes: Home, slides: bool = False) -> dict[str, Quantity]:
    """Return the quantities of some homes that a history of this contact has."""
    solid = contact.solid
    kinds = {"sites": not solid.in_lengths, "continua": solid.in_lengths, "yielding": solid.yields}
    of = [kind for kind, it_is in kinds.items() if it_is]
    return select(*homes, of=["all", *of, *["sliding"] * slides])


Units = Mapping[str, str]
"""Unit of each dimension."""

_SYSTEMS = {
    "length": ("height unit", "length unit", "m"),
    "area": ("", "length unit^2", "m^2"),
    "force": ("stiffness unit * height unit", "force unit", "N"),
    "energy": ("stiffness unit * height unit^2", "force unit * length unit", "J"),
    "energy / place": ("stiffness unit * height unit^2 / lattice spacing", "force unit", "N"),
    "energy / area": ("", "force unit / length unit", "J/m^2"),
    "pressure": ("stiffness unit * height unit / site", "force unit / length unit^2", "Pa"),
    "stress": ("stiffness unit * height unit", "force unit / length unit^2", "Pa"),
    "velocity": ("stiffness unit * height unit * R unit", "length unit / time unit", "m/s"),
    "stiffness": ("", "force unit / length unit", "N/m"),
    "time": ("1 / (stiffness unit * R unit)", "time unit", "s"),
    "place": ("lattice spacing", "length unit", "m"),
    "place / time": ("lattice spacing * stiffness unit * R unit", "length unit / time unit", "m/s"),
}
"""Units of solids that are defined on sites, of continua in the user's own units, and of continua in SI."""

_SITES, _OWN, _SI = (
    {dimension: units[system] for dimension, units in _SYSTEMS.items() if units[system]}
    for system in range(3)
)
_SI_OF_A_LINE = {"area": "m", "force": "N/m", "energy": "J/m", "energy / place": "N/m", "stiffness": "N/m^2"}
"""Of a profile, which stands for a surface of ridges: for each metre of their length."""

_OWN_OF_A_LINE = {
    "area": "length unit",
    "force": "force unit / length unit",
    "energy": "force unit",
    "energy / place": "force unit / length unit",
    "stiffness": "force unit / length unit^2",
}


def units_of(contact: Bodies) -> Units:
    """Units of a contact's numbers, by dimension; those of a solid defined on sites are the user's own."""
    units = (_SI if contact.si else _OWN) if contact.solid.in_lengths else _SITES
    if contact.lattice.dimension == 1:
        of_line = _SI_OF_A_LINE if units is _SI else _OWN_OF_A_LINE if units is _OWN else {}
        return units | {"rim": "1"} | of_line
    return units | {"rim": units["place"]}


def describe(dataset: xr.Dataset, facts: Mapping[str, tuple[str, str]], units: Units) -> None:
    """Give the variables of a Dataset their long names and units, from long names and dimensions."""
    for name in facts.keys() & dataset.variables.keys():
        long_name, dimension = facts[name]
        dataset[name].attrs.update(long_name=long_name, units=units.get(dimension, dimension))


def units_named(named: Mapping[str, str]) -> Units:
    """Units of dimensions, from those of recorded quantities by name."""
    quantities = select()
    units = {quantities[name].dimension: unit for name, unit in named.items() if name in quantities}
    systems = (_SITES, _OWN, _OWN | _OWN_OF_A_LINE, _SI, _SI | _SI_OF_A_LINE)
    telling = {d: units[d] for d in ("time", "force", "pressure", "velocity") if d in units}
    alike = (system for system in systems if telling and telling.items() <= system.items())
    return next(alike, {}) | units
