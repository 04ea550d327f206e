"""Disks that fill up, users who stop a run, readers who go away: nothing half-written is left."""

import os
import re
import signal
import subprocess
import sys
from contextlib import suppress

import numpy as np
import pytest

from asperity.app.cli import main
from asperity.base.files import MARKER, mark
from tests.cli.conftest import SMALL, process
from tests.surfaces import uncorrelated

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="needs POSIX signals and limits")


def limited(size):
    """Let no file grow beyond a size; Python's own bytecode files must not be cut off by it."""
    limit = f"import resource; resource.setrlimit(resource.RLIMIT_FSIZE, ({size}, {size}))"
    return f"sys.dont_write_bytecode = True\n{limit}"


@pytest.mark.slow
@pytest.mark.parametrize("earlier", [False, True])
def test_a_disk_that_fills_up_keeps_an_earlier_run_and_leaves_no_other(tmp_path, earlier):
    out = tmp_path / "out"
    if earlier:
        out.mkdir()
        (out / "summary.txt").write_text("earlier")
        mark(out / MARKER, "run", ["summary.txt"])
    # The history fits into this limit of any file, and the first figure does not; into the other, neither.
    full = limited(200 if earlier else 20_000)
    running = process("run", *SMALL, "--quiet", "--overwrite", "--out", out, before=full)
    text, error = running.communicate(timeout=60)
    assert (running.returncode, text) == (1, "")
    assert error == f"asperity: could not write {out}: File too large; nothing was left there\n"
    assert list(tmp_path.iterdir()) == [out] * earlier
    assert not earlier or (out / "summary.txt").read_text() == "earlier"


LISTEN = "import signal\nsignal.signal(signal.SIGINT, signal.default_int_handler)\n"
"""Python ignores the signal if it was started with it ignored, as in a shell's background."""


def stopping(stop, at):
    """Let a process send itself a signal when it says this, however slow its reader is."""
    return f"""{LISTEN}import os, sys
write = sys.stderr.write
def said(text):
    if text.startswith({at!r}):
        os.kill(os.getpid(), {int(stop)})
    return write(text)
sys.stderr.write = said
"""


@pytest.mark.parametrize("stop", [signal.SIGINT, pytest.param(signal.SIGTERM, marks=pytest.mark.slow)])
def test_a_run_that_is_stopped(tmp_path, stop):
    running = process("run", *SMALL, "--out", tmp_path / "out", before=stopping(stop, "  t = 0.001"))
    out, error = running.communicate(timeout=60)
    assert (running.returncode, out) == (130, "")
    assert error.splitlines()[-1] == "asperity: interrupted; nothing was written"
    assert "Traceback" not in error
    assert list(tmp_path.iterdir()) == []


@pytest.mark.slow
def test_a_long_run_that_is_killed_goes_on_to_the_same_result(tmp_path):
    often = "import asperity.app.cli.asking as command\ncommand._CHECKPOINT_EVERY = 0.0"
    flags = ("--shape", "64,64", "--last", "1e6")
    for stop, at in ((signal.SIGKILL, "  t = 1 "), (signal.SIGINT, "  t = 100")):
        running = process("run", *flags, "--out", tmp_path / "out", before=stopping(stop, at) + often)
        _, error = running.communicate(timeout=60)
        (place,) = (path for path in tmp_path.iterdir() if not path.name.startswith("."))
        assert place.name.startswith("out.")
        assert place.suffix == ".checkpoint"
    assert error.splitlines()[-1] == f"asperity: interrupted; the same command resumes from {place}"
    running = process("run", *flags, "--out", tmp_path / "out", before=often)
    text, error = running.communicate(timeout=60)
    assert running.returncode == 0
    assert f"resuming from {place}" in error
    assert re.search(r"cost .* s in this session\n", text)
    assert "  t = 0.001" not in error
    assert main(["run", *flags, "--quiet", "--out", str(tmp_path / "undisturbed")]) == 0
    for name in ("aging.csv", "config.toml"):
        assert (tmp_path / "out" / name).read_bytes() == (tmp_path / "undisturbed" / name).read_bytes()
    assert {path.name for path in tmp_path.iterdir()} == {"out", "undisturbed"}


def test_a_disk_that_fills_up_keeps_the_checkpoint_and_says_so(tmp_path):
    np.save(tmp_path / "scan.npy", uncorrelated(32))
    flags = (
        "--file-unit",
        "nm",
        "--pixel-size",
        "1um",
        "--young",
        "3GPa",
        "--pressures",
        "0.1MPa",
        "0.12MPa",
    )
    # The checkpoint fits into this limit of any file, and the picture does not.
    running = process(
        "law", "--surface", tmp_path / "scan.npy", *flags, "--out", tmp_path / "out", before=limited(20_000)
    )
    _, error = running.communicate(timeout=60)
    (place,) = tmp_path.glob("out.*.checkpoint")
    said = f"could not write {tmp_path / 'out'}: File too large; nothing was left there"
    assert error.splitlines()[-1] == f"asperity: {said}; the same command resumes from {place}"


@pytest.mark.slow
def test_a_reader_who_goes_away(tmp_path):
    running = process("run", *SMALL, "--out", tmp_path / "out")
    assert running.stdout is not None
    running.stdout.close()
    assert running.stderr is not None
    error = running.stderr.read()
    running.stderr.close()
    running.wait(timeout=60)
    assert "Traceback" not in error
    assert "Exception ignored" not in error
    assert (tmp_path / "out" / "summary.txt").exists()


@pytest.mark.parametrize("stop", ["SIGINT", "SIGTERM"])
@pytest.mark.parametrize("becomes", ["KeyboardInterrupt", "ImportError"])
def test_an_interruption_while_the_program_starts(stop, becomes):
    # Raised where a library of the command line begins to be imported, which may make another error of it.
    early = f"""{LISTEN}import os
class Finder:
    def find_spec(self, name, *_):
        if name == "cyclopts":
            try:
                os.kill(os.getpid(), signal.{stop})
            except KeyboardInterrupt:
                raise {becomes} from None
sys.meta_path.insert(0, Finder())"""
    running = process("--version", before=early)
    assert running.communicate(timeout=60) == ("", "asperity: interrupted; nothing was written\n")
    assert running.returncode == 130


@pytest.mark.slow
@pytest.mark.parametrize("stop", [signal.SIGINT, signal.SIGTERM])
def test_a_campaign_that_is_stopped_while_its_workers_start(tmp_path, stop):
    (tmp_path / "plan.toml").write_text("surface.shape = [64, 64]\nsweep.seeds = 50\n")
    # Sent where the first worker is about to be started.
    early = f"""{LISTEN}import os
if __name__ == "__main__":
    from distributed import Nanny
    begin = Nanny.__init__
    def stopped(*words, **more):
        os.kill(os.getpid(), {int(stop)})
        begin(*words, **more)
    Nanny.__init__ = stopped"""
    words = ("sweep", tmp_path / "plan.toml", "--out", tmp_path / "out", "--workers", "1", "--quiet")
    running = process(*words, before=early)
    assert running.communicate(timeout=100)[1] == (
        "asperity: interrupted; 0 runs are done, and the same command does the rest\n"
    )
    assert running.returncode == 130


def test_help_in_a_terminal_of_one_column():
    for columns in ("0", "1"):
        words = [sys.executable, "-m", "asperity", "fit", "--help"]
        narrow = os.environ | {"COLUMNS": columns}
        done = subprocess.run(words, env=narrow, check=True, capture_output=True, text=True, timeout=60)
        assert max(map(len, done.stdout.splitlines())) == 40


@pytest.mark.slow
def test_figures_are_drawn_whatever_a_notebook_asks_for(finished, tmp_path):
    table, figure = str(finished / "aging.csv"), str(tmp_path / "a.png")
    words = [sys.executable, "-m", "asperity", "fit", table, "--out", figure]
    notebook = os.environ | {"MPLBACKEND": "module://no_such_backend"}
    done = subprocess.run(words, env=notebook, check=False, capture_output=True, text=True, timeout=120)
    assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.slow
@pytest.mark.parametrize("stream", [1, 2])
def test_a_stream_that_is_closed(tmp_path, stream):
    words = [sys.executable, "-m", "asperity", "run", "--shape", "8,8", "--times", "1", "--figures", ""]
    shell = f'exec "$@" {stream}>&-'
    command = ["sh", "-c", shell, "sh", *words, "--out", str(tmp_path / "out")]
    done = subprocess.run(command, check=False, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0
    assert "Traceback" not in done.stdout + done.stderr
    assert "asperity:" not in done.stdout + done.stderr
    assert (tmp_path / "out" / "summary.txt").exists()


@pytest.mark.slow
def test_a_stream_without_the_letters(finished, tmp_path):
    table, figure = str(finished / "aging.csv"), str(tmp_path / "a.png")
    words = [sys.executable, "-m", "asperity", "fit", table, "--out", figure]
    ascii_only = os.environ | {"PYTHONIOENCODING": "ascii"}
    done = subprocess.run(words, env=ascii_only, check=False, capture_output=True, text=True, timeout=120)
    assert (done.returncode, done.stderr) == (0, "")
    assert " +- " in done.stdout


@pytest.mark.slow
def test_on_a_terminal_there_is_a_bar(tmp_path):
    pty = pytest.importorskip("pty")
    ours, theirs = pty.openpty()
    code = "import sys; from asperity.app.cli import main; sys.exit(main(sys.argv[1:]))"
    words = [sys.executable, "-c", code, "run", *SMALL, "--out", str(tmp_path / "out")]
    with subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=theirs) as running:
        os.close(theirs)
        shown = b""
        with suppress(OSError):  # the terminal is gone
            while piece := os.read(ours, 4096):
                shown += piece
    os.close(ours)
    assert running.returncode == 0
    assert b"\x1b[" in shown
    assert b"aging" in shown


@pytest.mark.slow
@pytest.mark.parametrize(("command", "at"), [("infer", "chains: R-hat"), ("sweep", "runs on 2 workers")])
def test_the_workers_of_a_killed_command_end(tmp_path, command, at):
    (tmp_path / "infer").write_text("t,A\n" + "".join(f"{2**n},{10 + n}\n" for n in range(12)))
    (tmp_path / "sweep").write_text("surface.shape = [256, 256]\nsweep.seeds = 50\n")
    sampled = ["--sample"] if command == "infer" else []
    words = (command, tmp_path / command, *sampled, "--workers", "2", "--out", tmp_path / "out")
    with process(*words, before=stopping(signal.SIGKILL, at)) as running:
        running.wait(timeout=200)
        running.communicate(timeout=20)  # ends when nobody has the output any more
    assert running.returncode == -signal.SIGKILL
