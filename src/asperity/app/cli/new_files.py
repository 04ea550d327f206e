"""Whether a file or a folder can be written, asked before anything is computed or imported for it."""

from __future__ import annotations

from pathlib import Path

from asperity.base.files import Standing, standing
from asperity.errors import InputError, OutputError

FIGURE_SUFFIXES = (".png", ".pdf", ".svg")

_SIGNS = (
    {"history.zarr", "config.toml", "summary.txt"},
    {"history.zarr", "prediction.html", "summary.txt"},
    {"friction.toml", "friction.csv"},
    {"inference.html", "verdicts.csv", "summary.txt"},
)
"""Files by which the folder of a run, a prediction, a fit of friction and an inference is known."""

_FILES = set().union(*_SIGNS) - {"friction.toml", "friction.csv"} | {"solid.toml", "priors.toml"}
_STEMS = {
    *("aging", "history", "sliding", "contacts", "patches", "carried", "growth", "pressure", "relaxation"),
    *("observed", "friction", "resolution", "curve", "parameters", "corner", "posterior"),
}
"""Files and pictures that may be replaced."""


def check_new_file(flag: str, target: Path, suffixes: tuple[str, ...], *, overwrite: bool) -> Standing:
    """Make sure, before anything is computed, that a file can be written; give what stands there."""
    if target.suffix.lower() not in suffixes:
        expected, advice = f"a name that ends in {', '.join(suffixes)}", f"{flag} {target}{suffixes[0]}"
        raise InputError(flag, expected=expected, got=target, advice=advice)
    if target.is_dir() or not target.parent.is_dir():
        raise InputError(flag, expected="a file in a folder that exists", got=target)
    if target.exists() and not overwrite:
        kept = f"{target}, which is kept"
        raise InputError(flag, expected="a new file", got=kept, advice="another name, or --overwrite")
    try_writing(flag, target, target.parent)
    return standing(target)


def check_free(out: Path, *, overwrite: bool) -> Standing:
    """Make sure, before anything is computed, that the results can be written; give what they may replace."""
    folder = out.resolve()
    if folder == Path.cwd() or folder in Path.cwd().parents:
        raise InputError("--out", expected="a folder of its own", got=out, advice="--out results")
    if out.exists() and not out.is_dir():
        raise InputError("--out", expected="a folder", got=f"{out}, which is a file")
    if found := {path.name for path in out.iterdir()} if out.exists() else set():
        foreign = sorted(name for name in found - _FILES if Path(name).stem not in _STEMS)
        expected, held, advice = "a new folder", "", "another name"
        if not any(signs <= found for signs in _SIGNS):
            held = "something else than a run"
        elif not overwrite:
            held, advice = "a run", "another name, or --overwrite"
        elif foreign:
            expected, held = "a run's folder with nothing else in it", f"{foreign[0]} too"
            advice = "another name, or moving that away"
        if held:
            got = f"{out}, which holds {held} and is kept"
            raise InputError("--out", expected=expected, got=got, advice=advice)
    ground = folder.parent
    while not ground.exists():
        ground = ground.parent
    try_writing("--out", out, ground)
    return standing(out) if overwrite else frozenset()


def try_writing(flag: str, target: Path, folder: Path) -> None:
    """Write and remove something: permissions do not tell of read-only disks and full quotas."""
    import tempfile  # for which the help does not wait

    try:
        with tempfile.TemporaryDirectory(prefix=".asperity-", dir=folder):
            pass
    except OSError as error:
        raise OutputError(f"{flag}: cannot write {target}: {error.strerror}: {folder}") from error
