"""One run of a campaign, in a worker process: idempotent, and something tiny comes back."""

from __future__ import annotations

import time as clock
from pathlib import Path
from typing import Literal

from asperity.campaign.store import Store
from asperity.config import RunConfig
from asperity.errors import AsperityError, OutputError
from asperity.results import Checkpoint
from asperity.runs import Silent, execute

State = Literal["done", "failed", "busy", "disk"]
Report = tuple[str, State, str]
"""Identity, state, and, where there is something to say, the reason."""

_CHECKPOINT_EVERY = 30.0


def run_task(directory: str, identity: str, config: str) -> Report:
    """Do one run, unless it is done already or another process is at it.

    Parameters
    ----------
    directory
        Folder of the campaign.
    identity
        Name of the run.
    config
        Its configuration, as JSON.

    Returns
    -------
    Report
        ``failed`` runs are recorded in the store; ``disk`` means that nothing could be recorded.
    """
    store = Store(Path(directory))
    if store.is_done(identity):
        return identity, "done", ""
    try:
        with store.claim(identity) as mine:
            if not mine:
                return identity, "busy", ""
            if not store.is_done(identity):
                _compute(store, identity, RunConfig.model_validate_json(config))
            return identity, "done", ""
    except OutputError as error:
        return identity, "disk", str(error)
    except (AsperityError, ArithmeticError, MemoryError) as error:
        reason = f"{error}" if isinstance(error, AsperityError) else f"{type(error).__name__}: {error}"
        return _failed(store, identity, " ".join(reason.split()))
    except OSError as error:
        return identity, "disk", f"{directory}: {error.strerror or error}"


def _compute(store: Store, identity: str, config: RunConfig) -> None:
    begin = clock.perf_counter()
    place = store.checkpoint(identity)
    outcome = execute(config, Silent(), checkpoint=Checkpoint(place, every=_CHECKPOINT_EVERY))
    store.write(identity, outcome, clock.perf_counter() - begin)
    place.unlink(missing_ok=True)
    store.forgive(identity)


def _failed(store: Store, identity: str, reason: str) -> Report:
    try:
        store.fail(identity, reason)
    except OutputError as error:
        return identity, "disk", str(error)
    return identity, "failed", reason
