"""Whether a file or a folder can be written, asked before anything is computed or imported for it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from asperity.app.cli.options import Drawn, Results
from asperity.base.files import (
    FORMATS,
    MARKER,
    Standing,
    marker_of,
    named,
    standing,
    table_beside,
    without_links,
)
from asperity.errors import InputError, OutputError

FIGURE_SUFFIXES = tuple(f".{one}" for one in FORMATS)


def check_new_file(flag: str, target: Path, suffixes: tuple[str, ...], *, overwrite: bool) -> Standing:
    """Check, before anything is computed, that a file can be written; return what it replaces."""
    if target.suffix.lower() not in suffixes:
        expected, advice = f"a name that ends in {', '.join(suffixes)}", f"{flag} {target}{suffixes[0]}"
        raise InputError(flag, expected=expected, got=target, advice=advice)
    if target.is_dir() or not target.parent.is_dir():
        raise InputError(flag, expected="a file in a folder that exists", got=target)
    if target.exists() and not overwrite:
        got = f"{target}, which exists"
        raise InputError(flag, expected="a new file", got=got, advice="another name, or --overwrite")
    try_writing(flag, target, target.parent)
    return standing(target)


def check_figures(
    flag: str, out: Path, drawn: Drawn, *, overwrite: bool, source: Path | None = None
) -> dict[Path, Standing]:
    """Names of a figure in its formats, by default that of its name, with what they replace.

    The last is the table of its data, which never replaces the source of the numbers, nor that of a figure
    unless it is to overwrite.
    """
    files = [out] if drawn.figures is None else [out.with_suffix(f".{one}") for one in drawn.formats()]
    pictures = {file: check_new_file(flag, file, FIGURE_SUFFIXES, overwrite=overwrite) for file in files}
    tables = [table_beside(out, source)] * bool(files)
    return pictures | {table: check_new_file(flag, table, (".csv",), overwrite=overwrite) for table in tables}


@dataclass(frozen=True)
class NewFolder:
    """A folder to which results can be written, how they are told, and what they replace."""

    path: Path
    results: Results
    replaced: Standing


def check_free(out: Path, results: Results) -> NewFolder:
    """Check, before anything is computed, that the results can be written."""
    folder = without_links(out)
    if folder == Path.cwd() or folder in Path.cwd().parents:
        raise InputError("--out", expected="a folder of its own", got=out, advice="--out results")
    if out.exists() and not out.is_dir():
        raise InputError("--out", expected="a folder", got=f"{out}, which is a file")
    if names := {path.name for path in out.iterdir()} if out.exists() else set():
        marker = marker_of(out)
        foreign = sorted(names - {MARKER, *marker.get("files", ())})
        expected, content, advice = "a new folder", "", "another name"
        if not marker:
            content = f"no {MARKER}, the mark of results"
        elif marker["kind"] == "campaign":
            content = named("campaign")
        elif not results.overwrite:
            content, advice = named(marker["kind"]), "another name, or --overwrite"
        elif foreign:
            expected, content = "a folder of results with nothing else in it", f"{foreign[0]}, too"
            advice = "another name, or moving that away"
        if content:
            got = f"{out}, which contains {content}"
            raise InputError("--out", expected=expected, got=got, advice=advice)
    try_writing("--out", out, next(one for one in folder.parents if one.exists()))
    return NewFolder(out, results, standing(out) if results.overwrite else frozenset())


def try_writing(flag: str, target: Path, folder: Path) -> None:
    """Write and remove something: permissions do not tell of read-only disks and full quotas."""
    import tempfile  # for which the help does not wait

    try:
        with tempfile.TemporaryDirectory(prefix=".asperity-", dir=folder):
            pass
    except OSError as error:
        raise OutputError(f"{flag}: cannot write {target}: {error.strerror}: {folder}") from error
