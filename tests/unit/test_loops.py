"""Compiled loops: the same machine code whatever ran before, always a place to keep it, and no silence."""

import ast
import importlib
import inspect
import os
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import asperity as asp
from asperity.app.cli import main
from asperity.app.runs import loops
from asperity.contact import compiled
from asperity.contact.stencils import forces
from asperity.errors import Remark

HISTORIES = """
import hashlib, numpy as np, asperity as asp
def history(shape, load=80.0, hold=None, **solid):
    heights = np.random.default_rng(1).normal(size=shape)
    contact = asp.press(heights, asp.solids.spring_lattice(k0=1.0, k1=3.0, **solid), load=load)
    aged = asp.age(contact, [0.1, 1.0, 10.0], hold=hold)
    limit = asp.relax(contact, hold=hold)
    fields = [aged.dataset[name].values for name in sorted(aged.dataset.data_vars)]
    fields += [aged.final.u, aged.final.u0, limit.u, limit.u0]
    return hashlib.sha256(b"".join(field.tobytes() for field in fields)).hexdigest()
"""
CASES = [
    "history((64, 64))",
    "history((37, 50), R_viscous=0.1)",
    "history((40, 41), R_viscous=0.1, hold='separation')",
    "history((64,), load=8.0)",
]


def run_python(code, **environment):
    return subprocess.run(
        [sys.executable, "-c", code],
        env=os.environ | environment,
        capture_output=True,
        text=True,
        check=False,
        timeout=900,
    )


OF_MULTIGRID = [f"multigrid.loops.{name}" for name in ("one_field", "rows", "states", "two_fields")]
NAMES = (*OF_MULTIGRID, "stencils")
MODULES = [f"asperity.contact.{name}" for name in NAMES]
TREES = {name: ast.parse(inspect.getsource(importlib.import_module(name))) for name in MODULES}
COMPILED_SO = {
    module: {
        node.name: ast.unparse(node.decorator_list[0])
        for node in tree.body
        if isinstance(node, ast.FunctionDef) and node.decorator_list
    }
    for module, tree in TREES.items()
}
LOOPS = {name for ways in COMPILED_SO.values() for name, way in ways.items() if way == "compiled"}
"""Loops that Python calls."""


def test_no_other_module_has_loops():
    source = Path(asp.__file__).parent
    having = {
        ".".join(["asperity", *path.relative_to(source).with_suffix("").parts])
        for path in source.rglob("*.py")
        if "\n@compiled\n" in path.read_text()
    }
    # A slider's record is followed by one loop, compiled at its first fit.
    assert having == {*MODULES, "asperity.friction.marching"}


@pytest.mark.parametrize("module", MODULES)
def test_loops_that_others_call_are_inlined(module):
    compiled_so, tree = COMPILED_SO[module], TREES[module]
    bodies = [node for node in tree.body if isinstance(node, ast.FunctionDef) and node.name in compiled_so]
    loops_in = [node for node in bodies if compiled_so[node.name] in ("compiled", "inlined")]
    called = {
        node.func.id
        for body in loops_in
        for node in ast.walk(body)
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in compiled_so
    }
    for name in called:
        assert compiled_so[name] in ("inlined", "intrinsic"), name
    imported = {
        name.asname or name.name
        for node in ast.walk(tree)
        if isinstance(node, ast.ImportFrom) and str(node.module).startswith("asperity")
        for name in node.names
    }
    inside = {
        node.id
        for body in loops_in
        for line in body.body
        for node in ast.walk(line)
        if isinstance(node, ast.Name)
    }
    for name in imported & inside:  # a change of a number elsewhere would not be noticed
        assert any(ways.get(name) in ("inlined", "intrinsic") for ways in COMPILED_SO.values())


@pytest.mark.slow
def test_the_process_that_compiles_gets_what_others_get(tmp_path):
    found = [
        run_python(HISTORIES + "".join(f"print({case})\n" for case in cases), NUMBA_CACHE_DIR=str(tmp_path))
        for cases in (CASES, CASES[::-1])
    ]
    first, second = (run.stdout.split() for run in found)
    assert len(set(first)) == len(CASES), found[0].stderr
    assert first == second[::-1]
    assert "compiling loops" in found[0].stderr
    assert "compiling loops" not in found[1].stderr


@pytest.mark.slow
def test_all_loops_are_compiled_beforehand():
    code = (
        HISTORIES
        + """
from asperity.app.runs import loops
from importlib import import_module
loops.stamp_of = lambda *_: None
loops.compile_loops(print, print)
"""
        + f"modules = [import_module(name) for name in {MODULES}]"
        + """
def known():
    return {
        (n, s) for m in modules for n, f in vars(m).items() if hasattr(f, "signatures") for s in f.signatures
    }
before = known()
"""
        + "".join(f"{case}\n" for case in CASES)
        + "asp.press(np.random.default_rng(0).normal(size=(68, 68)), "
        "asp.solids.half_space(modulus=1.0), load=3.0)\n"
        + "print(len(before), *known() - before)\n"
        + f"print(*set({sorted(LOOPS)}) - {{name for name, _ in before}})"
    )
    *_, last, never = run_python(code).stdout.splitlines()
    assert int(last) >= len(LOOPS)  # and no name after the number
    assert never == ""


WITHOUT_A_PLACE = """
import sys
from numba.core import caching
caching.CacheImpl._locator_classes = [caching.UserProvidedCacheLocator]
import numpy as np
from asperity.contact import compiled
from asperity.contact.multigrid.loops import rows as loops
print(loops.wrap.stats.cache_path)
compiled.tell_of_place(print)
line, row = np.arange(4.0), np.zeros((2, 3))
loops.part(line, row)
print(row.tolist())
compiled.tell_of_place(print)
"""


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="owners and modes are those of POSIX")
def test_where_nothing_can_be_written_a_folder_for_temporary_files_serves(tmp_path):
    place = tmp_path / f"asperity-numba-{os.getuid()}"
    for _ in range(2):
        ran = run_python(WITHOUT_A_PLACE, TMPDIR=str(tmp_path), NUMBA_CACHE_DIR="")
        cache, remark, row = ran.stdout.splitlines()
        assert cache.startswith(str(place))
        assert row == "[[0.0, 2.0, 0.0], [0.0, 1.0, 3.0]]"
        assert f"kept in {place}, as neither" in remark
        assert "NUMBA_CACHE_DIR sets another folder" in remark
        assert list(place.glob("*/rows.part*.nbc"))
        assert place.stat().st_mode & 0o777 == 0o700


@pytest.mark.skipif(sys.platform == "win32", reason="owners and modes are those of POSIX")
@pytest.mark.parametrize("kind", ["open to all", "a link"])
def test_a_folder_that_others_may_write_to_is_refused(tmp_path, kind):
    place = tmp_path / f"asperity-numba-{os.getuid()}"
    if kind == "a link":
        (tmp_path / "elsewhere").mkdir(mode=0o700)
        place.symlink_to(tmp_path / "elsewhere")
    else:
        place.mkdir()
        place.chmod(0o777)
    ran = run_python(WITHOUT_A_PLACE, TMPDIR=str(tmp_path), NUMBA_CACHE_DIR="")
    cache, remark, _ = ran.stdout.splitlines()
    assert cache == "None"
    assert "kept nowhere, so that every run compiles them anew" in remark
    assert not list(place.iterdir())


def test_a_wrong_scan_is_refused_before_anything_is_compiled_or_pressed(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(loops, "stamp_of", lambda *_: None)
    np.savetxt(tmp_path / "scan.txt", np.random.default_rng(0).normal(size=(8, 8)))
    units = ("--file-unit", "nm", "--pixel-size", "0.1", "0.2", "--length-unit", "um")
    out = str(tmp_path / "out")
    assert main(["run", "--file", str(tmp_path / "scan.txt"), *units, "--out", out]) == 2
    *stages, refusal = capsys.readouterr().err.splitlines()
    assert stages == ["making the surface"]
    assert "expected square pixels" in refusal


def test_a_stamp_spares_the_second_run(tmp_path, monkeypatch):
    told: list[str] = []
    stamp = tmp_path / "stamp"
    monkeypatch.setattr(loops, "stamp_of", lambda *_: stamp)
    loops.compile_loops(told.append)
    loops.compile_loops(told.append)
    assert told == [compiled.COMPILING]
    assert stamp.exists()


def test_machine_code_that_was_cut_off_is_made_anew_and_a_full_disk_is_named(tmp_path, monkeypatch):
    kept: Any = compiled._CacheFile(str(tmp_path), "loop", "stamp")
    for change in (lambda _: b"", lambda content: content[: len(content) // 2]):
        for ending in ("nbi", "nbc"):
            kept.save("key", {"code": list(range(100))})
            assert kept.load("key") == {"code": list(range(100))}
            (file,) = tmp_path.glob(f"*.{ending}")
            file.write_bytes(change(file.read_bytes()))
            assert kept.load("key") is None

    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(kept, "_open_for_write", full)
    with pytest.warns(Remark, match=f"not kept in {tmp_path}: .*No space left on device"):
        kept.save("another", {})


@pytest.mark.slow
def test_loops_are_compiled_where_others_are_not_to_be(tmp_path):
    code = "import numpy as np; from asperity.contact.multigrid.loops import rows; row = np.zeros((2, 3))\n"
    code += "rows.part(np.arange(4.0), row); import numba; print(row.tolist(), numba.config.DISABLE_JIT)"
    ran = run_python(code, NUMBA_DISABLE_JIT="1", NUMBA_CACHE_DIR=str(tmp_path))
    assert ran.stdout == "[[0.0, 2.0, 0.0], [0.0, 1.0, 3.0]] 1\n"


def test_compiling_on_the_way_is_remarked_once():
    watch, event = compiled._Watch(), SimpleNamespace(data={"dispatcher": forces})
    with pytest.warns(Remark, match="compiling loops"):
        watch.on_start(event)
    watch.on_start(event)  # a second remark would be an error
