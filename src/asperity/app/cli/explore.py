"""The command ``asperity explore``: a page in the browser, or in a file."""

from __future__ import annotations

from pathlib import Path

from asperity.app.cli.new_files import check_new_file
from asperity.app.explore.export import exported_page
from asperity.app.explore.folders import entries, open_entry
from asperity.app.explore.scene import pack
from asperity.base import checks
from asperity.errors import InputError
from asperity.results.store import whole_file

_PORTS = 65535


def explore(folder: Path | None, *, port: int | None, browser: bool) -> None:
    """Serve the page until Ctrl-C.

    `InputError` if there is no such folder, or the port cannot be had; `MissingExtraError` without the
    libraries of the server.
    """
    if folder is not None:
        _check_folder(folder)
    if port is not None and not 1 <= port <= _PORTS:
        raise InputError("--port", expected=f"a number from 1 to {_PORTS}", got=port)
    with checks.extra("explore", "the page"):
        from asperity.app.explore.server import serve

    def told(address: str) -> None:
        print(f"{address}  (Ctrl-C to end)", flush=True)

    serve(folder, port=port, told=told, browser=browser)


def export(folder: Path | None, page: Path, *, overwrite: bool) -> None:
    """Write the page of a folder to one file: of a campaign its curves, and the maps of its first run.

    `InputError` if there is no such folder, it holds none or several results, or the file cannot be written.
    """
    if folder is None:
        raise InputError("--export", expected="a folder of results", got="none", advice="its name")
    _check_folder(folder)
    check_new_file("--export", page, (".html", ".htm"), overwrite=overwrite)
    found = entries(folder)
    if len(found) != 1:
        got = f"{folder}, which holds {len(found)} results"
        advice = f"{folder / found[0]['path']}" if found else ""
        raise InputError("folder", expected="one run, prediction or campaign", got=got, advice=advice)
    opened = open_entry(folder, found[0]["path"])
    messages = [] if opened.campaign is None else [pack(*opened.campaign)]
    messages += [] if opened.recording is None else opened.recording.messages()
    title = found[0]["title"]
    with whole_file(page) as part:
        part.write_text(exported_page(messages, title=f"{title} · Asperity"), encoding="utf-8")
    print(page)


def _check_folder(folder: Path) -> None:
    if not folder.is_dir():
        got = f"{folder}, which is a file" if folder.exists() else f"{folder}, which does not exist"
        raise InputError("folder", expected="a folder of results", got=got)
