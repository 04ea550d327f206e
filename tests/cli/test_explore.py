"""The command ``asperity explore``: a page in a file, and what it refuses."""

from __future__ import annotations

import socket
import sys
from pathlib import Path

import pytest

from tests.cli.conftest import Asperity


def test_a_run_becomes_a_file(asperity: Asperity, finished: Path, tmp_path: Path) -> None:
    page = tmp_path / "page.html"
    status, out, err = asperity("explore", "--export", page, finished)
    assert (status, out, err) == (0, f"{page}\n", "")
    text = page.read_text(encoding="utf-8")
    assert text.startswith("<!doctype html>")
    assert f"<title>{finished.name} · Asperity</title>" in text
    status, _, err = asperity("explore", "--export", page, finished)
    assert status == 2
    assert "try another name, or --overwrite" in err
    assert asperity("explore", "--export", page, finished, "--overwrite")[0] == 0


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--export", "page.html"), "--export: expected a folder of results, got none; try its name"),
        (
            ("--export", "page.html", "nothing"),
            "folder: expected a folder of results, got nothing, which does",
        ),
        (
            ("--export", "page.html", "."),
            "folder: expected one run, prediction or campaign, got ., which holds 0",
        ),
        (("--export", "page.pdf", "."), "--export: expected a name that ends in .html, .htm, got page.pdf"),
        (("nothing",), "folder: expected a folder of results, got nothing, which does not exist"),
        (("--port", "0"), "--port: expected a number from 1 to 65535, got 0"),
        (("--port", "70000"), "--port: expected a number from 1 to 65535, got 70000"),
    ],
)
def test_what_cannot_be_is_refused_in_one_line(
    asperity: Asperity, words: tuple[str, ...], said: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    status, out, err = asperity("explore", *words)
    assert (status, out) == (2, "")
    assert err.startswith(f"asperity: {said}")
    assert err.count("\n") == 1
    assert not list(tmp_path.iterdir())


def test_a_folder_of_several_results_says_how_to_choose(
    asperity: Asperity, finished: Path, tmp_path: Path
) -> None:
    for name in ("one", "two"):
        (tmp_path / name).symlink_to(finished)
    (tmp_path / "link").mkdir()
    for name in ("one", "two"):
        (tmp_path / "link" / name).mkdir()
        for part in finished.iterdir():
            (tmp_path / "link" / name / part.name).symlink_to(part)
    status, _, err = asperity("explore", "--export", tmp_path / "page.html", tmp_path / "link")
    assert status == 2
    assert "which holds 2 results; try" in err


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
    assert "try pip install 'asperity[explore]'" in err
    assert err.count("\n") == 1
    assert asperity("explore", "--export", tmp_path / "page.html", finished)[0] == 0
