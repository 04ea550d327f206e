"""One contact as a Dataset of maps, saved, loaded, and judged anew."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from asperity.base import checks, views
from asperity.carried import PullOff
from asperity.contact import Contact, Load, Separation
from asperity.contact.anchors import AnchorFields
from asperity.contact.bodies import Bodies
from asperity.contact.instantaneous import above_anchors
from asperity.contact.problem import Guess, Solution
from asperity.contact.publish import contact_from
from asperity.contact.system import System
from asperity.errors import InputError
from asperity.lattice import Lattice
from asperity.patches import patches
from asperity.results.dataset import attributes_of, attributes_of_solid, coordinates_of, describe_recorded
from asperity.results.quantities import had_by, units_of
from asperity.results.store import load, save
from asperity.solids import Solid

if TYPE_CHECKING:
    import xarray as xr


@views.defines(Contact._dataset)
def contact_dataset(contact: Contact) -> xr.Dataset:
    """Gather the maps and numbers of a contact; see `Contact.dataset`."""
    import xarray as xr

    places = coordinates_of(contact)
    names = {"heights", *had_by(contact, "field", "contact")} - {"u0"}
    maps = {name: getattr(contact, name) for name in sorted(names)}
    numbers = {name: getattr(contact, name) for name in had_by(contact, "series") if hasattr(contact, name)}
    dataset = xr.Dataset(
        {name: (("branch", *places)[-field.ndim :], field) for name, field in maps.items()} | numbers,
        places,
    )
    describe_recorded(dataset, contact)
    return dataset.assign_attrs({"title": "A rough contact", **attributes_of(contact, contact.control)})


@views.defines(Contact.save)
def save_contact(contact: Contact, path: str | Path, *, overwrite: bool = False) -> None:
    """See `Contact.save`."""
    save(contact.dataset, path, overwrite=overwrite)


@views.defines(PullOff._path)
def pull_off_path(pull: PullOff, contact: Contact) -> xr.Dataset:
    """See `PullOff.path`."""
    import xarray as xr

    numbers = patches(contact.in_contact, edges=contact.lattice.edges)
    last = np.full(numbers.sizes.size + 1, np.inf)
    touching = contact.in_contact
    np.minimum.at(last, numbers.labels[touching], pull.opened[touching])
    units = units_of(contact)
    length, force = units["length"], units["force"]
    places = coordinates_of(contact)
    contact_area = pull.area * contact.lattice.cell
    when = "approach at which the last site of the patch opened"
    dataset = xr.Dataset(
        {
            "approach": ("step", pull.approach, _said("approach since the aged contact", length)),
            "force": ("step", pull.normal_force, _said("normal force, negative where it pulls", force)),
            "area": ("step", pull.area, _said("sites in contact", "sites")),
            "contact_area": ("step", contact_area, _said("real contact area", units["area"])),
            "opened": ((*places,), pull.opened, _said("approach at which the site opened", length)),
            "patch": ((*places,), numbers.labels, _said("number of the patch of the aged contact", "1")),
            "let_go": ("number", last[1:], _said(when, length)),
        },
        {"number": np.arange(1, last.size), **places},
    )
    facts = {"title": "A contact pulled apart", "work_of_adhesion": pull.work, "pull_off": pull.force}
    return dataset.assign_attrs({**facts, **attributes_of(contact, contact.control)})


def _said(long_name: str, units: str) -> dict[str, str]:
    return {"long_name": long_name, "units": units}


def load_contact(path: str | Path, solid: Solid) -> Contact:
    """Read a contact that `Contact.save` wrote, to press it anew, age it, or relax it.

    Parameters
    ----------
    path
        The zarr folder.
    solid
        The solid of that contact, made in the same way; a file holds its numbers, not its laws.

    Returns
    -------
    Contact
        With the residual of the loaded fields. Its numbers may differ in their last digits.

    Raises
    ------
    InputError
        There is no such folder, it holds no contact, or the contact is of another solid.
    ConvergenceError
        The loaded fields are not in equilibrium on this solid.
    """
    data = load(path)
    if "anchors" not in data:
        expected, advice = "a contact that Contact.save wrote", "history.final.save(path)"
        raise InputError("path", expected=expected, got=f"{path}, which holds none", advice=advice)
    checks.instance("solid", solid, Solid, "asperity.solids.spring_lattice(k0=1.0, k1=3.0)")
    facts = data.attrs
    attributes = attributes_of_solid(solid)
    if wrong := [name for name, value in attributes.items() if facts.get(name) != value]:
        expected = ", ".join(f"{name} {facts.get(name, 'none')}" for name in wrong)
        got = ", ".join(f"{name} {attributes[name]}" for name in wrong)
        raise InputError("solid", expected=f"that of the saved contact: {expected}", got=got)
    heights = data["heights"].values
    lattice = Lattice(heights.shape, tuple(json.loads(facts["spacing"])), facts["edges"])
    indentation = data["permanent_indentation"].values if solid.yields else 0.0
    bodies = Bodies(heights, lattice, solid, json.loads(facts["surface"]), bool(facts["si"]), indentation)
    kind = Load if facts["held"] == Load.name else Separation
    system = System.of(heights, lattice, solid, kind(facts[f"held_{kind.name}"]))
    position, touching = float(data["separation"]) - system.datum, data["in_contact"].values
    # u loses digits beside a large datum, which the gap keeps; a load moves anchors into place.
    surface, anchors = (data[name].values - system.datum for name in ("u", "anchors"))
    body = np.isfinite(heights)
    surface[body] = heights[body] - system.datum + data["gap"].values[body]
    whole = lattice.embedding
    if whole.body:  # fields beyond free edges follow from those within
        near = Guess(whole.extended(surface, position), whole.extended(touching, beyond=False))
        return above_anchors(whole.extended(anchors, position), position, bodies, system, near)
    if system.load:
        moved = system.body.displacement(surface, anchors, system.held(position))
        anchors, position = anchors + moved, position + moved
    solution = Solution(surface, touching, int(data["iterations"]), 0)
    return contact_from(system, solution, AnchorFields(anchors), position, bodies=bodies)
