"""``--open``, ``asperity explore --export``, and ``--install-completion``."""

import socket
import subprocess
import sys
import webbrowser
from pathlib import Path
from unittest.mock import Mock

import pytest

from asperity.app.cli.computing import open_results
from tests.cli.conftest import SMALL, told


@pytest.fixture
def opened(monkeypatch):
    """What the browser was given."""
    given: list[str] = []
    monkeypatch.setattr(webbrowser, "open", lambda address: given.append(address) or True)  # type: ignore[func-returns-value]
    return given


def test_a_run_opens_its_picture(asperity, opened, tmp_path):
    out = tmp_path / "a run"
    assert asperity("run", *SMALL, "--out", out, "--quiet", "--open") == (0, "", "")
    assert opened == [(out / "aging.png").as_uri()]
    assert asperity("run", *SMALL, "--out", out, "--quiet", "--open")[0] == 2  # it is there already
    assert len(opened) == 1


def test_the_page_or_the_picture_is_opened_or_else_the_folder(opened, tmp_path):
    for files, shown in (
        ("prediction.html growth.png contacts.png history.csv", "prediction.html"),
        ("history.svg contacts.svg aging.csv", "history.svg"),
        ("contacts.pdf aging.csv", "contacts.pdf"),
        ("aging.csv summary.txt", ""),
    ):
        out = tmp_path / files
        (out / "history.zarr").mkdir(parents=True)
        for name in files.split():
            (out / name).touch()
        open_results(out)
        assert opened[-1] == (out / shown).as_uri()


def test_where_nothing_opens_it_the_place_is_told(capsys, monkeypatch, tmp_path):
    monkeypatch.setattr(webbrowser, "open", lambda _: False)
    open_results(tmp_path)
    assert capsys.readouterr().err == f"remark: no program opens {tmp_path}\n"


def test_bash_completes_commands_and_flags(says, monkeypatch, tmp_path):
    monkeypatch.setenv("HOME", str(tmp_path))
    for name in ("XDG_DATA_HOME", "BASH_COMPLETION_USER_DIR"):
        monkeypatch.delenv(name, raising=False)
    said = says("--install-completion", "--shell", "bash")
    script = Path(said.partition("installed to ")[2].splitlines()[0])
    assert script.is_relative_to(tmp_path)

    def completed(*words):
        line = " ".join(words)
        ask = f'source "{script}"; COMP_WORDS=({line}); COMP_CWORD={len(words) - 1}; _asperity; '
        ask += 'printf "%s\\n" "${COMPREPLY[@]}"'
        found = subprocess.run(["bash", "-c", ask], capture_output=True, text=True, check=True, timeout=60)
        return set(found.stdout.split())

    assert completed("asperity", "pre") == {"predict"}
    assert completed("asperity", "run", "--hur") == {"--hurst"}
    assert {"--load", "--length-unit"} <= completed("asperity", "run", "--l")
    assert completed("asperity", "predict", "--modulus", "sh") == {"shear"}


def test_a_shell_that_is_not_recognized_is_asked_for(asperity, monkeypatch, capsys):
    from cyclopts.completion import detect

    monkeypatch.setattr(detect, "detect_shell", Mock(side_effect=detect.ShellDetectionError))
    with pytest.raises(SystemExit):
        asperity("--install-completion")
    assert "--shell" in capsys.readouterr().err


def test_a_run_becomes_a_file(asperity, finished, tmp_path):
    page = tmp_path / "page.html"
    status, out, err = asperity("explore", "--export", page, finished)
    assert (status, out, err) == (0, f"{page}\n", "")
    text = page.read_text(encoding="utf-8")
    assert text.startswith("<!doctype html>")
    assert f"<title>{finished.name} · Asperity</title>" in text
    assert asperity("explore", "--export", page, finished)[0] == 2
    assert asperity("explore", "--export", page, finished, "--overwrite")[0] == 0


def test_a_taken_port_is_one_line(asperity):
    pytest.importorskip("uvicorn", reason="needs the extra explore")
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        status, out, err = asperity("explore", "--no-browser", "--port", str(port))
    assert (status, out) == (2, "")
    assert err.startswith(f"asperity: --port: expected a free port, got {port}: ")
    assert err.count("\n") == 1


def test_without_its_libraries_it_says_what_to_install(asperity, finished, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "uvicorn", None)
    monkeypatch.delitem(sys.modules, "asperity.app.explore.server", raising=False)
    status, out, err = asperity("explore", "--no-browser")
    assert (status, out) == (1, "")
    told(err.removeprefix("asperity: ").rstrip())
    assert asperity("explore", "--export", tmp_path / "page.html", finished)[0] == 0
