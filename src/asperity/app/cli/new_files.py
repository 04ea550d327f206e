"""Whether a file can be written, asked before anything is computed or imported for it."""

from __future__ import annotations

from pathlib import Path

from asperity.base.files import Standing, standing
from asperity.errors import InputError, OutputError

FIGURE_SUFFIXES = (".png", ".pdf", ".svg")


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


def try_writing(flag: str, target: Path, folder: Path) -> None:
    """Write and remove something: permissions do not tell of read-only disks and full quotas."""
    import tempfile  # for which the help does not wait

    try:
        with tempfile.TemporaryDirectory(prefix=".asperity-", dir=folder):
            pass
    except OSError as error:
        raise OutputError(f"{flag}: cannot write {target}: {error.strerror}: {folder}") from error
