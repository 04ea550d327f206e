"""The experiments that come with the package: a file each."""

from __future__ import annotations

from importlib.resources import files
from pathlib import Path

from asperity_research import doors
from asperity_research.experiments.record import Experiment, read

_FOLDER = Path(str(files("asperity_research.experiments") / "data"))


def names() -> tuple[str, ...]:
    """Return the names of the experiments that come with the package."""
    return tuple(sorted(path.stem for path in _FOLDER.glob("*.toml")))


def load(name: str | Path) -> Experiment:
    """Read an experiment by its name, or from a file of your own (.toml).

    Raises
    ------
    InputError
        There is none of that name; the nearest names are given. Or as `read`.
    """
    if isinstance(name, str | Path) and Path(name).suffix == ".toml":
        return read(Path(name))
    return read(doors.named("experiment", name, {one: _FOLDER / f"{one}.toml" for one in names()}))
