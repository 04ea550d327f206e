"""The command ``asperity explore``: a page in a file, and what it refuses."""

from __future__ import annotations

import socket
import sys
from pathlib import Path

import pytest

from tests.cli.conftest import Asperity, Refused, told


def test_a_run_becomes_a_file(asperity: Asperity, finished: Path, tmp_path: Path) -> None:
    page = tmp_path / "page.html"
    status, out, err = asperity("explore", "--export", page, finished)
    assert (status, out, err) == (0, f"{page}\n", "")
    text = page.read_text(encoding="utf-8")
    assert text.startswith("<!doctype html>")
    assert f"<title>{finished.name} · Asperity</title>" in text
    assert asperity("explore", "--export", page, finished)[0] == 2
    assert asperity("explore", "--export", page, finished, "--overwrite")[0] == 0


def test_what_cannot_be_is_refused_in_one_line(refused: Refused, finished: Path) -> None:
    for name in ("one", "two"):
        Path("two results", name).mkdir(parents=True)
        for part in finished.iterdir():
            Path("two results", name, part.name).symlink_to(part)
    Path("empty").mkdir()
    for words in (
        ("--export", "page.html"),
        ("--export", "page.html", "nothing"),
        ("--export", "page.html", "empty"),
        ("--export", "page.html", "two results"),
        ("--export", "page.pdf", "two results"),
        ("nothing",),
        ("--port", "0"),
        ("--port", "70000"),
    ):
        refused("explore", *words)


def test_a_taken_port_is_one_line(asperity: Asperity) -> None:
    pytest.importorskip("uvicorn", reason="needs the extra explore")
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        status, out, err = asperity("explore", "--no-browser", "--port", str(port))
    assert (status, out) == (2, "")
    assert err.startswith(f"asperity: --port: expected a free port, got {port}: ")
    assert err.count("\n") == 1


def test_without_its_libraries_it_says_what_to_install(
    asperity: Asperity, finished: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "uvicorn", None)
    monkeypatch.delitem(sys.modules, "asperity.app.explore.server", raising=False)
    status, out, err = asperity("explore", "--no-browser")
    assert (status, out) == (1, "")
    told(err.removeprefix("asperity: ").rstrip())
    assert asperity("explore", "--export", tmp_path / "page.html", finished)[0] == 0
