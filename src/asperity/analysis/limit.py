"""Put the relaxed state beside the history that creeps toward it."""

from __future__ import annotations

import xarray as xr

from asperity.contact.state import Contact
from asperity.errors import InputError
from asperity.results.history import check_dataset


def with_limit(dataset: xr.Dataset, limit: Contact) -> xr.Dataset:
    """Add the relaxed state to a history.

    Parameters
    ----------
    dataset
        The dataset of a `History`.
    limit
        The state from `asperity.relax`, of the same surface.

    Returns
    -------
    Dataset
        A copy with the fields ``in_contact_relaxed`` and ``u_relaxed`` and the attributes
        ``relaxed_area`` (sites), ``relaxed_load``, ``relaxed_separation``, ``relaxed_energy`` and
        ``relaxed_residual``.

    Raises
    ------
    InputError
        The state is of another lattice.
    """
    check_dataset(dataset)
    sites = dataset["heights"].dims
    if limit.heights.shape != dataset["heights"].shape:
        raise InputError(
            "limit", expected=f"a contact of shape {dataset['heights'].shape}", got=limit.heights.shape
        )
    touching = {"long_name": "whether the site is in contact in the relaxed state", "units": "1"}
    unit = dataset["heights"].attrs.get("units", "height unit")
    height = {"long_name": "height of the elastic surface in the relaxed state", "units": unit}
    numbers = ("area", "load", "separation", "energy", "residual")
    return dataset.assign(
        in_contact_relaxed=(sites, limit.in_contact, touching), u_relaxed=(sites, limit.u, height)
    ).assign_attrs({f"relaxed_{name}": getattr(limit, name) for name in numbers})
