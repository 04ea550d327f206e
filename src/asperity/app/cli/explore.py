"""The command ``asperity explore``: a page in the browser, or in a file."""

from __future__ import annotations

from pathlib import Path

from asperity.app.cli.command import command
from asperity.app.cli.flags import Switch, Whole
from asperity.app.cli.new_files import check_new_file
from asperity.errors import InputError

_PORTS = 65535


@command()
def explore(
    folder: Path | None = None,
    /,
    *,
    port: Whole | None = None,
    no_browser: Switch = False,
    export: Path | None = None,
    overwrite: Switch = False,
) -> None:
    """Show contacts that age, on a page in the browser, or write the page to a file.

    Without a folder, choose a surface, a solid and a load on the page. With a folder of runs, predictions or
    campaigns, the page shows their results. Ctrl-C ends it.

    Parameters
    ----------
    folder
        Folder of results to show.
    port
        Port to listen on. [default: the first free one from 8765]
    no_browser
        Only print the address.
    export
        Write the page with the results to this file (.html), which needs no server.
    overwrite
        Replace that file if it exists.
    """
    if folder is not None and not folder.is_dir():
        got = f"{folder}, which is a file" if folder.exists() else f"{folder}, which does not exist"
        raise InputError("folder", expected="a folder of results", got=got)
    if export is not None:
        _export(folder, export, overwrite=overwrite)
        return
    if port is not None and not 1 <= port <= _PORTS:
        raise InputError("--port", expected=f"a number from 1 to {_PORTS}", got=port)
    from asperity.base import checks

    with checks.extra("explore", "the page"):
        from asperity.app.explore.server import serve

    def print_address(address: str) -> None:
        print(f"{address}  (Ctrl-C to end)", flush=True)

    serve(folder, port=port, tell=print_address, browser=not no_browser)


def _export(folder: Path | None, page: Path, *, overwrite: bool) -> None:
    """Write the page of a folder to one file: of a campaign its curves, and the maps of its first run."""
    if folder is None:
        raise InputError("--export", expected="a folder of results", got="none", advice="its name")
    before = check_new_file("--export", page, (".html", ".htm"), overwrite=overwrite)
    from asperity.app.explore.export import exported_page
    from asperity.app.explore.folders import entries, open_entry
    from asperity.app.explore.scene import pack
    from asperity.results.store import whole_file

    listing = entries(folder)
    if len(listing) != 1:
        got = f"{folder}, which holds {len(listing)} results"
        advice = f"{folder / listing[0]['path']}" if listing else ""
        raise InputError("folder", expected="one run, prediction or campaign", got=got, advice=advice)
    opened = open_entry(folder, listing[0]["path"])
    messages = [] if opened.campaign is None else [pack(*opened.campaign)]
    messages += [] if opened.recording is None else opened.recording.messages()
    title = listing[0]["title"]
    with whole_file(page, overwrite=before) as part:
        part.write_text(exported_page(messages, title=f"{title} · Asperity"), encoding="utf-8")
    print(page)
