"""What waits is told why, and does not wait for ever."""

from __future__ import annotations

import asyncio
from collections.abc import Coroutine
from concurrent.futures import ThreadPoolExecutor
from types import SimpleNamespace
from typing import Any

import pytest

from asperity.app.config import config_from
from asperity.app.explore.jobs import Jobs
from asperity.app.explore.scene import Recording

pytest.importorskip("uvicorn", reason="needs the extra explore")


def outcome_of(doing: Coroutine[Any, Any, Any]) -> Any:
    """Run in a thread, as the tests of the page in a browser leave a loop in this one."""
    with ThreadPoolExecutor(1) as aside:
        return aside.submit(asyncio.run, doing).result(timeout=60)


def test_a_run_that_waits_for_loops_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Jobs, "_start_worker", lambda _: None)

    async def ask() -> Recording:
        from asperity.app.explore.jobs import _Worker

        jobs = Jobs()
        process = SimpleNamespace(is_alive=lambda: True)
        worker = _Worker(process, SimpleNamespace(send=lambda _: None))  # type: ignore[arg-type]
        jobs._workers.append(worker)
        jobs._heard(worker, "stage", "compiling loops")  # before anything was asked for
        recording = jobs.ask(config_from({}, {}, None), {}, "").recording
        assert recording.stage == "compiling loops"
        jobs._heard(worker, "ready", None)
        return recording

    assert outcome_of(ask()).stage == "starting"


def test_a_connection_whose_sending_fails_is_closed() -> None:
    from starlette.websockets import WebSocketDisconnect

    from asperity.app.explore.server import Session

    class Socket:
        def __init__(self) -> None:
            self.codes: list[int] = []
            self.closed = asyncio.Event()

        async def accept(self) -> None: ...

        async def send_bytes(self, _: bytes) -> None: ...

        async def receive_text(self) -> str:
            await self.closed.wait()
            raise WebSocketDisconnect

        async def close(self, code: int = 1000) -> None:
            self.codes.append(code)
            self.closed.set()

    async def serve() -> list[int]:
        socket: Any = Socket()
        server: Any = SimpleNamespace(hello=lambda: {"kind": "hello", "odd": object()})
        with pytest.raises(TypeError):  # for the terminal: a fault of ours
            await asyncio.wait_for(Session(socket, server).run(), 5)
        return list(socket.codes)

    assert outcome_of(serve())[0] == 1011
