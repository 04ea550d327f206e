"""One run of a campaign in a worker process, which stores the results and returns a short report."""

from __future__ import annotations

import json
import time as clock
from pathlib import Path
from typing import Literal

from asperity.app.campaign.plan import content_of
from asperity.app.campaign.store import Store
from asperity.app.config import RunConfig
from asperity.app.runs import Progress, answer
from asperity.base.version import __version__
from asperity.errors import AsperityError, CheckpointError, InputError, OutputError
from asperity.results import Checkpoint

State = Literal["done", "failed", "busy", "disk", "version"]
Report = tuple[str, State, str]
"""Identity, state, and, where there is something to say, the reason."""

_CHECKPOINT_EVERY = 30.0


def run_task(
    directory: str, identity: str, config: str, content: str = "", version: str = __version__
) -> Report:
    """Do one run, unless it is done or another process computes it.

    The configuration is JSON; the content, if any, the checksum of its files, which must not have
    changed since it was planned; the version, of what planned it, must be the worker's. ``failed`` runs
    are recorded in the store; ``disk`` means that nothing could be recorded.
    """
    if version != __version__:
        return identity, "version", f"a worker runs asperity {__version__}, the campaign {version}"
    store = Store(directory)
    if store.is_done(identity):
        return identity, "done", ""
    try:
        with store.claim(identity) as mine:
            if not mine:
                return identity, "busy", ""
            try:
                if not store.is_done(identity):
                    _compute(store, identity, RunConfig.read(json.loads(config)), content)
            except OSError:
                raise
            except (AsperityError, ArithmeticError, MemoryError) as error:
                said = f"{error}" if isinstance(error, AsperityError) else f"{type(error).__name__}: {error}"
                reason = " ".join(said.split())
                store.fail(identity, reason)
                return identity, "failed", reason
            return identity, "done", ""
    except OutputError as error:
        return identity, "disk", str(error)
    except OSError as error:
        return identity, "disk", f"{directory}: {error.strerror or error}"


def _compute(store: Store, identity: str, config: RunConfig, content: str) -> None:
    begin = clock.perf_counter()
    place = Checkpoint(store.checkpoint(identity), every=_CHECKPOINT_EVERY)
    try:
        outcome = answer(config, Progress(), checkpoint=place)
    except CheckpointError:  # it only saves time: without it the run begins anew
        Path(place.path).unlink(missing_ok=True)
        outcome = answer(config, Progress(), checkpoint=place)
    # What was read of a scan says its checksum, and was hashed as it was read; a table is short.
    read = json.loads(outcome.dataset.attrs.get("surface", "{}")).get("sha256")
    known = {str(config.surface.file): read} if read else {}
    if content != content_of(config, known):
        raise InputError("surface", expected="the file as it was planned", got="one that has changed since")
    store.write(identity, outcome, clock.perf_counter() - begin)
    Path(place.path).unlink(missing_ok=True)
    store.forgive(identity)
