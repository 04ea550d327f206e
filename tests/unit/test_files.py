"""Files of users: nothing that was not there when a command began is ever removed by it."""

import hashlib
import json
import os
import signal
import subprocess
import sys
from pathlib import Path
from unittest.mock import Mock

import numpy as np
import pytest

import asperity as asp
from asperity import results
from asperity.app.cli import main
from asperity.app.cli.terminal import make_streams_safe
from asperity.app.config.reading import config_from, read_config
from asperity.base import files
from asperity.base.files import content_of, expanded, standing
from asperity.base.words import counted
from asperity.errors import CheckpointError, ConfigError, InputError, OutputError, TooLargeError, printable
from asperity.results import whole_file, whole_folder
from asperity.results.checkpoint import Keeper
from tests.campaign.conftest import do_here
from tests.cli.conftest import SMALL
from tests.refusals import each_refuses


def folder(name, *, overwrite=False, meanwhile=lambda: None):
    with whole_folder(Path(name), overwrite=overwrite) as made:
        (made / "result").write_text("new")
        meanwhile()


def file(name, *, overwrite=frozenset(), meanwhile=lambda: None):
    with whole_file(Path(name), overwrite=overwrite) as part:
        part.write_text("new")
        meanwhile()


def contents(where):
    return {
        path.relative_to(where).as_posix(): path.read_text() for path in where.rglob("*") if path.is_file()
    }


def come(path, text="mine"):
    Path(path).parent.mkdir(parents=True, exist_ok=True)
    Path(path).write_text(text)


@pytest.mark.parametrize("name", ["out", "n" * 245, "µ" * 120])
def test_what_came_while_results_were_written_is_kept_and_the_results_stand_beside_it(here, name):
    with pytest.raises(OutputError, match="the results are in") as raised:
        folder(name, meanwhile=lambda: come(f"{name}/thesis/1.txt"))
    (kept,) = (path for path in here.iterdir() if path.name != name)
    assert str(raised.value).endswith(f"in {kept.name}")
    assert contents(here) == {f"{name}/thesis/1.txt": "mine", f"{kept.name}/result": "new"}


@pytest.mark.parametrize("write", [folder, file])
def test_of_what_stands_there_only_what_stood_there_before_goes(here, write):
    there = "out/mine" if write is folder else "out"
    come(there)
    before = standing(Path("out"))
    write("out", overwrite=before)
    assert "mine" not in contents(here).values()
    before = standing(Path("out"))
    come(there, "later")
    with pytest.raises(OutputError, match="the results are in out-2"):
        write("out", overwrite=before)
    assert contents(here)[there] == "later"
    with pytest.raises(OutputError, match="the results are in out-3"):
        write("out", overwrite=before, meanwhile=lambda: come("out/more" if write is folder else "out"))
    assert sorted(path.name for path in here.iterdir()) == ["out", "out-2", "out-3"]


@pytest.mark.parametrize("fault", [OSError, KeyboardInterrupt])
def test_what_stood_there_comes_back_if_the_new_cannot_take_its_name(here, monkeypatch, fault):
    come("out/mine")
    monkeypatch.setattr("asperity.results.store._rename", Mock(side_effect=fault))
    with pytest.raises((OutputError, KeyboardInterrupt)):
        folder("out", overwrite=True)
    assert contents(here) == {"out/mine": "mine"}


def test_an_empty_folder_is_replaced_and_a_file_is_not(here):
    (here / "out").mkdir()
    folder("out", meanwhile=lambda: (here / "out" / "empty").mkdir() or (here / "out" / "empty").rmdir())
    assert contents(here) == {"out/result": "new"}
    with pytest.raises(OutputError, match="the results are in new-2"):
        folder("new", meanwhile=lambda: come("new"))
    assert contents(here) == {"out/result": "new", "new": "mine", "new-2/result": "new"}


@pytest.mark.parametrize("write", [folder, file])
def test_of_two_writers_one_keeps_the_name_and_the_other_says_so(here, write):
    with pytest.raises(OutputError, match="the results are in new/out-2"):
        write("new/out", meanwhile=lambda: write("new/out"))
    assert list(contents(here).values()) == ["new", "new"]


def test_a_command_keeps_what_came_while_it_computed(here, monkeypatch, capsys):
    from asperity.app.runs import answer

    def answered(*words, **more):
        come("out/thesis/1.txt")
        return answer(*words, **more)

    monkeypatch.setattr("asperity.app.runs.answer", answered)
    assert main(["run", *SMALL, "--quiet", "--out", "out"]) == 1
    assert capsys.readouterr().err.splitlines()[-1] == (
        "asperity: out holds what was not there when this began, and is kept; the results are in out-2"
    )
    assert (here / "out" / "thesis" / "1.txt").read_text() == "mine"
    assert {"aging.csv", "summary.txt"} <= {path.name for path in (here / "out-2").iterdir()}
    assert sorted(path.name for path in here.iterdir()) == ["out", "out-2"]


@pytest.mark.skipif(sys.platform == "win32", reason="needs POSIX signals")
def test_what_a_killed_writer_left_goes_and_what_a_living_one_writes_stays(here):
    code = """import time; from pathlib import Path; from asperity.results.store import whole_folder
with whole_folder(Path("out")) as made: print(made, flush=True); time.sleep(60)"""
    with subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True) as writer:
        assert writer.stdout is not None
        made = Path(writer.stdout.readline().strip())
        folder("out")
        assert made.exists()
        os.kill(writer.pid, signal.SIGKILL)
    folder("out", overwrite=True)
    assert [path.name for path in here.iterdir()] == ["out"]


# -- Reading -------------------------------------------------------------------------------------------------


def test_pipes_are_read_once_or_again_and_devices_and_silent_pipes_are_refused(here, monkeypatch):
    handle, into = os.pipe()
    os.write(into, b"t,v\n1,2\n")
    os.close(into)
    shell = Path(f"/dev/fd/{handle}")
    assert [content_of(shell) for _ in range(2)] == [b"t,v\n1,2\n"] * 2
    os.close(handle)
    monkeypatch.setattr(files, "_PATIENCE", 0.0)
    os.mkfifo("silent")
    each_refuses(
        *((name, content_of, Path(name)) for name in ("/dev/zero", "/dev/null", "silent")),
        got="a device | a device | none for 5 s",
    )
    with subprocess.Popen([sys.executable, "-c", "open('silent', 'w').write('1 2')"]):
        monkeypatch.setattr(files, "_PATIENCE", 60.0)
        assert content_of(Path("silent")) == b"1 2"


def test_a_spectrum_from_a_pipe_is_known_by_its_content():
    table = b"q,C\n0.1,1\n1,0.1\n9,0.01\n"
    handle, into = os.pipe()
    os.write(into, table)
    os.close(into)
    surface = {"kind": "spectrum", "path": f"/dev/fd/{handle}", "shape": [8]}
    made = config_from({"surface": surface}, {}, None).surface.build()
    os.close(handle)
    assert made.provenance["sha256"] == hashlib.sha256(table).hexdigest()


def test_a_command_asks_again_for_what_a_pipe_held(here, capsys):
    os.mkfifo("curve")
    write = "open('curve', 'w').write('t,area\\n' + ''.join(f'{t},{1 + t / 9}\\n' for t in range(1, 9)))"
    with subprocess.Popen([sys.executable, "-c", write]):
        assert main(["infer", "curve", "--walkers", "10"]) == 2
    assert "--walkers" in capsys.readouterr().err


def test_more_text_than_memory_has_room_for_is_refused(here, monkeypatch):
    come("text", "1234567\n")
    monkeypatch.setattr(files, "available", lambda: 8 * files._TIMES)
    assert content_of(Path("text")) == b"1234567\n"
    monkeypatch.setattr(files, "available", lambda: 7 * files._TIMES)
    with pytest.raises(TooLargeError):
        content_of(Path("text"))


def test_a_tilde_is_the_home_in_flags_files_and_python(here, monkeypatch):
    monkeypatch.setenv("HOME", str(here / "home"))
    (here / "home").mkdir()
    np.savetxt(here / "home" / "t.csv", np.c_[np.geomspace(1, 100, 9), np.linspace(1, 2, 9)], delimiter=",")
    np.save(here / "home" / "s.npy", np.random.default_rng(0).normal(size=(8, 8)))
    assert main(["fit", "~/t.csv", "--out=~/figure.png"]) == 0
    assert (here / "home" / "figure.png").exists()
    come("run.toml", '[surface]\npath = "~/s.npy"\n')
    come("sweep.toml", '[sweep]\npath = ["~/s.npy"]\n')
    assert read_config("run.toml", {}).surface.file == here / "home" / "s.npy"
    plan = asp.campaign.read_plan("sweep.toml")
    assert plan.runs[0].config.surface.file == here / "home" / "s.npy"
    do_here(plan, here / "home" / "swept")
    assert asp.campaign.sweep(plan, "~/swept").done == 1
    assert not (here / "~").exists()
    assert asp.surfaces.read("~/s.npy", periodic="wrap").heights.shape == (8, 8)
    assert asp.fits.read_measurements("~/t.csv").time.size == 9
    assert expanded("~no such user/x") == Path("~no such user/x")


@pytest.mark.parametrize("text", [r'path = "C:\Users\scan.npy"', r'path = "scans\scan.npy"'])
def test_a_backslash_in_quotes_has_a_hint(here, text):
    come("run.toml", f"[surface]\n{text}\n")
    with pytest.raises(ConfigError, match=r"a path with \\ needs single quotes: 'C:\\scan.npy'"):
        read_config("run.toml", {})


def test_thin_spaces_between_thousands_are_printed():
    make_streams_safe()
    assert printable(f"{counted(1910, 'site')}\x1b") == "1\u202f910 sites\\x1b"
    assert "1\u202f910 sites".encode("ascii", "asperity") == b"1 910 sites"


@pytest.mark.parametrize(
    "words",
    [
        ("run", "--shape", "8", "--out", "loop"),
        ("run", "--shape", "8", "--out", "first", "--overwrite"),
        ("run", "--shape", "8", "--out", "first/inside"),
        ("fit", "t.csv", "--out", "loop.png"),
        ("surface", "s.npy", "--out", "loop.png"),
        ("sweep", "sweep.toml", "--out", "loop"),
        ("explore", ".", "--export", "loop.html"),
    ],
)
def test_links_in_a_circle_are_refused(here, capsys, words):
    for name, target in (("loop", "loop"), ("first", "second"), ("second", "first")):
        for ending in ("", ".png", ".html"):
            (here / f"{name}{ending}").symlink_to(f"{target}{ending}")
    np.savetxt("t.csv", np.c_[np.geomspace(1, 100, 9), np.linspace(1, 2, 9)], delimiter=",")
    np.save("s.npy", np.eye(8))
    come("sweep.toml", "surface.shape = [8]\n[sweep]\nseeds = 2\n")
    assert main(words) == 2
    assert "expected a path, got links in a circle" in capsys.readouterr().err
    with pytest.raises(InputError, match="links in a circle"), whole_folder(here / "loop"):
        pass


def test_brackets_without_an_end_are_no_file_of_ours(here, capsys):
    deep = "[" * 100_000
    come("solid.toml", f"a = {deep}")
    (here / "results").mkdir()
    come("results/asperity.json", deep)
    come("place", deep)
    with pytest.raises(InputError, match=r"solid\.toml: not a TOML file"):
        asp.relaxation.material("solid.toml")
    with pytest.raises(InputError, match="which holds no history"):
        asp.results.load("results")
    with pytest.raises(CheckpointError):
        Keeper(here / "place", b"asked").read()
    for flags in ((), ("--overwrite",)):
        assert main(["run", "--shape", "8", "--out", "results", *flags]) == 2
        assert "which contains no asperity.json" in capsys.readouterr().err


@pytest.mark.skipif(sys.platform != "linux", reason="other disks take names in UTF-8 alone")
@pytest.mark.parametrize(
    ("name", "figures"),
    [
        (b"s\xff", []),
        ("\u00e4".encode() * 120, []),
        pytest.param(b"s\xff", ["png"], marks=pytest.mark.slow),
        pytest.param(b"\xe4" * 120, ["png"], marks=pytest.mark.slow),
        pytest.param(b"10:30 9\xe2\x80\xafAM\xc2\xa0", ["png"], marks=pytest.mark.slow),
    ],
)
def test_names_of_any_bytes_are_taken(here, name, figures):
    scan, table, out = (here / os.fsdecode(name + ending) for ending in (b".npy", b".csv", b""))
    np.save(scan, np.random.default_rng(0).normal(size=(8, 8)))
    np.savetxt(table, np.c_[np.geomspace(1, 100, 9), np.linspace(1, 2, 9)], delimiter=",")
    assert main(["run", "--surface", str(scan), "--figures", *(figures or [""]), "--out", str(out)]) == 0
    for ending in figures:
        assert main(["fit", str(table), "--out", f"{table}.{ending}"]) == 0
        assert main(["surface", str(scan), "--out", f"{scan}.{ending}"]) == 0
    known = read_config(out / "config.toml", {}).surface.file
    assert known.name == os.fsdecode(name + b".npy").encode(errors="replace").decode()
    record = json.loads(results.load(out).attrs["surface"])
    assert record["file"] == printable(scan.name)
    for path in (files.beside(out, ".partial"), files.beside(table, "")):
        assert len(os.fsencode(path.name)) <= 250
        path.touch()
