"""What the variables of a history are called, and their units: of sites, of the user's own, or SI."""

from __future__ import annotations

from collections.abc import Mapping

from asperity.contact.state import Contact

SERIES: dict[str, tuple[str, str]] = {
    "area": ("real contact area", "sites"),
    "contact_fraction": ("real contact area over nominal area", "1"),
    "load": ("normal load, the sum of the contact forces", "force"),
    "separation": ("separation, the mean of u0", "length"),
    "approach": ("rigid approach of the bodies since the start", "length"),
    "energy": ("elastic energy", "energy"),
    "residual": ("largest force off contact over the residual scale", "1"),
    "residual_scale": (
        "mean contact force, or where the load has died out the smallest that the heights resolve",
        "force",
    ),
    "steps": ("time steps since the previous entry", "1"),
    "rejected": ("time steps repeated with a smaller length since the previous entry", "1"),
    "iterations": ("iterations of the contact solver since the previous entry", "1"),
}
"""Long name and dimension of the time series of every history."""

OF_CONTINUA: dict[str, tuple[str, str]] = {
    "separation": ("separation, the position of the body; without an apparatus, the mean of u", "length"),
    "contact_area": ("real contact area, the area of the sites in contact", "area"),
    "contact_area_corrected": ("real contact area less what counting sites adds at the rim", "area"),
    "mean_gap": ("mean gap", "length"),
    "mean_contact_pressure": ("load over real contact area", "pressure"),
    "largest_pressure": ("largest contact pressure", "pressure"),
}
"""The same of those that continua, whose sites have an area, have besides or call otherwise."""

FIELDS: dict[str, tuple[str, str]] = {
    "u": ("height of the elastic surface", "length"),
    "u0": ("creeping shape of the elastic surface", "length"),
    "in_contact": ("whether the site is in contact", "1"),
}
FIELDS_OF_CONTINUA: dict[str, tuple[str, str]] = {"pressure": ("contact pressure", "pressure")}

LEG = "leg of the history, from 0"
COORDINATES: dict[str, tuple[str, str]] = {
    "time": ("hold time", "time"),
    "field_time": ("hold time at which fields were kept", "time"),
    "leg": (LEG, "1"),
    "field_leg": ("leg of the history in which fields were kept, from 0", "1"),
    "branch": ("branch of the solid, from 0", "1"),
    "x": ("site index along the last axis", "place"),
    "y": ("site index along the first axis", "place"),
    "heights": ("height of the rigid rough surface", "length"),
}

Units = Mapping[str, str]
"""Unit of each dimension."""

_SITES = {
    "length": "height unit",
    "force": "stiffness unit * height unit",
    "energy": "stiffness unit * height unit^2",
    "time": "1 / (stiffness unit * R unit)",
    "place": "lattice spacing",
}
_OWN = {
    "length": "length unit",
    "area": "length unit^2",
    "force": "force unit",
    "energy": "force unit * length unit",
    "pressure": "force unit / length unit^2",
    "time": "time unit",
    "place": "length unit",
}
_SI = {"length": "m", "area": "m^2", "force": "N", "energy": "J", "pressure": "Pa", "time": "s", "place": "m"}
_SI_OF_A_LINE = {"area": "m", "force": "N/m", "energy": "J/m"}
"""Of a profile, which stands for a surface of ridges: for each metre of their length."""


def units_of(contact: Contact) -> Units:
    """Units of a contact's numbers, by dimension; those of a solid defined on sites are the user's own."""
    if not contact.solid.in_lengths:
        return _SITES
    if not contact.si:
        return _OWN
    return _SI | _SI_OF_A_LINE if contact.lattice.dimension == 1 else _SI


def series_of(contact: Contact) -> dict[str, tuple[str, str]]:
    """Time series that a history of this contact has: long names and dimensions."""
    return SERIES | OF_CONTINUA if contact.solid.in_lengths else SERIES


def fields_of(contact: Contact) -> dict[str, tuple[str, str]]:
    """Fields that it keeps: long names and dimensions."""
    return FIELDS | FIELDS_OF_CONTINUA if contact.solid.in_lengths else FIELDS


def units_named(named: Mapping[str, str]) -> Units:
    """Units of dimensions, from those of series."""
    known = {name: dimension for name, (_, dimension) in (SERIES | OF_CONTINUA | COORDINATES).items()}
    return {known[name]: unit for name, unit in named.items()}
