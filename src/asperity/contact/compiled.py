"""How loops are compiled: the decorator, and where machine code is kept.

Numba keeps it beside the source or in the user's home. Where neither can be written, as in containers, it
is kept in a folder for temporary files that nobody else can write to, for numba runs what it finds there.
"""

from __future__ import annotations

import hashlib
import inspect
import os
import platform
import stat
import sys
import tempfile
from collections.abc import Callable
from contextlib import suppress
from functools import lru_cache
from pathlib import Path
from pickle import UnpicklingError
from typing import Any, ClassVar, TypeVar

import numba
from numba import extending, njit
from numba.core import config, event, registry
from numba.core.caching import IndexDataCacheFile

from asperity.base.calls import remark
from asperity.base.words import reason_of

COMPILING = "compiling loops (once on this machine, about half a minute)"

_remarks: list[str] = []
_settings: Any = config

F = TypeVar("F", bound=Callable[..., Any])

_OPTIONS = {
    "nogil": True,
    "no_cfunc_wrapper": True,
    "error_model": "numpy",
    "fastmath": {"contract", "reassoc", "nsz", "arcp", "nnan"},
}


def _compiler(**options: Any) -> Callable[[F], F]:
    """A decorator that compiles a loop when it is first called, and keeps the machine code on disk."""

    def compiled(function: F) -> F:
        kept, disabled = _settings.CACHE_DIR, _settings.DISABLE_JIT
        _settings.DISABLE_JIT = 0
        try:
            loop: F = njit(cache=True, **options)(function)
        except RuntimeError:  # numba finds no folder for it
            place = _private_folder()
            _settings.CACHE_DIR = str(place or "")
            loop = njit(cache=place is not None, **options)(function)
            _settings.CACHE_DIR = kept
            where = f"in {place}" if place else "nowhere, so that every run compiles them anew"
            _remarks[:] = [
                f"compiled loops are kept {where}, as neither the package nor the home can be written to; "
                "NUMBA_CACHE_DIR sets another folder"
            ]
            if place is None:
                return loop
        finally:
            _settings.DISABLE_JIT = disabled
        _notice_helpers(loop)
        return loop

    return compiled


def compiled(function: F) -> F:
    """Compile a loop that Python calls.

    Parameters are arguments, never globals: machine code is kept on disk, and a change of a number would not
    be noticed. A change of its module is, and of the modules that this imports from.
    """
    return _compiler(**_OPTIONS)(function)


def inlined(function: F) -> F:
    """Compile what other loops call.

    Without inlining each of them would hold a version of it, alike but for the order of its sums, and
    whichever was loaded first would serve all: last digits would depend on what ran before. It makes no array
    and counts no references to those it is given, which would take as long as a short row.
    """
    return _compiler(forceinline=True, _nrt=False, **_OPTIONS)(function)


def _notice_helpers(loop: Any) -> None:
    """Have machine code count as old when a module changes from which that of the loop imports.

    Numba looks at the module of the loop alone.
    """
    function = loop.py_func
    names = {str(getattr(value, "__module__", "")) for value in function.__globals__.values()}
    names = {name for name in names if name.startswith("asperity.") and name != function.__module__}
    files = [inspect.getfile(sys.modules[name]) for name in sorted(names)]
    kept = loop._cache._cache_file
    kept.__class__ = _CacheFile
    kept._source_stamp = (kept._source_stamp, *map(_digest, files))


class _CacheFile(IndexDataCacheFile):
    """Machine code on disk, without which a loop is compiled anew."""

    def load(self, key: object) -> object:
        kept: Any = super()
        try:
            return kept.load(key)
        except Exception:  # a file that was cut off leads the unpickler anywhere
            with suppress(OSError):
                kept.flush()
            return None

    def save(self, key: object, data: object) -> None:
        kept: Any = super()
        try:
            kept.save(key, data)
        except (OSError, EOFError, UnpicklingError) as error:
            message = f"compiled loops are not kept in {self._cache_path}: {reason_of(error)}"
            remark(f"{message}; NUMBA_CACHE_DIR sets another folder")


@lru_cache
def _digest(file: str) -> str:
    return hashlib.sha256(Path(file).read_bytes()).hexdigest()


def intrinsic(function: F) -> Callable[..., Any]:
    """Compile an operation that is given in the compiler's own terms; its first parameter is not passed."""
    operation: Callable[..., Any] = extending.intrinsic(function)
    return operation


def tell_of_place(tell: Callable[[str], None]) -> None:
    """Tell where machine code is kept, once, if that is an unusual place."""
    while _remarks:
        tell(_remarks.pop())


def stamp_of(*loops: Any) -> Path | None:
    """Name the file that says that all loops are compiled; None where machine code is not kept.

    One loop of each module is given.
    """
    folder = loops[0].stats.cache_path
    if folder is None:
        return None
    source = b"".join(Path(inspect.getfile(loop.py_func)).read_bytes() for loop in loops)
    machine = registry.cpu_target.target_context.codegen().magic_tuple()
    versions = (platform.python_version(), numba.__version__)
    mark = hashlib.sha256(source + repr((machine, versions)).encode()).hexdigest()[:16]
    return Path(folder) / f"loops-{mark}.compiled"


def _private_folder() -> Path | None:
    """A folder for temporary files that is this user's alone, or None if there cannot be one."""
    try:
        user = os.getuid() if sys.platform != "win32" else os.getlogin()
        folder = Path(tempfile.gettempdir()) / f"asperity-numba-{user}"
        folder.mkdir(mode=0o700, exist_ok=True)
        status = folder.lstat()
        tempfile.TemporaryFile(dir=folder).close()
    except OSError:
        return None
    mine = sys.platform == "win32" or (status.st_uid == user and not status.st_mode & 0o077)
    return folder if stat.S_ISDIR(status.st_mode) and mine else None


class _Watch(event.Listener):
    """Says so, once in a process, when a loop of a contact has to be compiled: half a minute is long.

    NUMBA_DISABLE_JIT, which is for finding mistakes in other programs, is not for what compiles these loops.
    """

    reported = False
    disabled: ClassVar[list[int]] = []

    def on_start(self, event: Any) -> None:
        self.disabled.append(_settings.DISABLE_JIT)
        _settings.DISABLE_JIT = 0
        if not self.reported and event.data["dispatcher"].py_func.__module__.startswith("asperity.contact."):
            self.reported = True
            tell_of_place(remark)
            remark(COMPILING)

    def on_end(self, _: Any) -> None:
        _settings.DISABLE_JIT = self.disabled.pop()


watch = _Watch()
_register: Any = event.register
_register("numba:compile", watch)
