"""The server of the page as a process, and a page that is no browser: a client of its websocket."""

from __future__ import annotations

import http.client
import json
import shutil
import signal
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from asperity.app.cli import main
from asperity.app.explore.scene import Arrays, Header, unpack
from tests.campaign.conftest import do_here, written
from tests.cli.conftest import process

Message = tuple[Header, Arrays]

QUICK: dict[str, Any] = {"surface": {"shape": [24, 24], "seed": 1}, "aging": {"first": 0.1, "last": 100.0}}
"""A configuration that takes a fraction of a second."""
SWEPT = """
surface.shape = [16, 16]
aging = { first = 0.1, last = 10.0, per_decade = 2 }
output.maps_at = [0.0, 10.0]
sweep = { load = [4.0, 12.0], seeds = 2 }
"""
LARGE: dict[str, Any] = {"surface": {"shape": [1024, 1024]}, "solid": {"kind": "half_space", "modulus": 1.0}}
"""One whose press takes many seconds."""


class Server:
    """``asperity explore`` as a process."""

    def __init__(self, *words: str | Path, before: str = "") -> None:
        self.process = process("explore", "--no-browser", *words, before=before)
        assert self.process.stdout is not None
        self.address = self.process.stdout.readline().split(" ")[0].rstrip("/")
        self.port = int(self.address.rpartition(":")[2] or 0)

    def end(self) -> tuple[int, str]:
        """Interrupt it, as Ctrl-C does; gives its status and what it said on the error stream."""
        self.process.send_signal(signal.SIGINT)
        _, errors = self.process.communicate(timeout=30)
        return self.process.returncode, errors

    def request(
        self, method: str, path: str, body: bytes | None = None, **headers: str
    ) -> tuple[int, bytes, http.client.HTTPMessage]:
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=30)
        named = {"Host": f"127.0.0.1:{self.port}", **headers}
        connection.request(method, path, body, named)
        response = connection.getresponse()
        content = response.read()
        connection.close()
        return response.status, content, response.headers

    def upload(self, name: str, content: bytes) -> tuple[int, dict[str, Any]]:
        status, answer, _ = self.request("POST", f"/files/{name}", content, Origin=self.address)
        return status, json.loads(answer) if answer[:1] == b"{" else {}

    @contextmanager
    def page(self, *, at: str = "", slow: bool = False, **options: Any) -> Iterator[Page]:
        """A page, at a host, that was told what there is; a slow one has not acknowledged that yet."""
        connect = pytest.importorskip("websockets.sync.client", reason="needs websockets").connect
        options = {"origin": self.address, "max_size": None, "compression": None, **options}
        with connect(f"ws://{at or f'127.0.0.1:{self.port}'}/socket", **options) as socket:
            page = Page(socket)
            page.hello, _ = page.receive(acknowledge=not slow)
            yield page


class Page:
    """One page that is connected."""

    def __init__(self, socket: Any) -> None:
        self.socket = socket
        self.sequence = 0
        self.hello: Header = {}

    def send(self, kind: str, **content: Any) -> None:
        self.socket.send(json.dumps({"kind": kind, **content}))

    def receive(self, *, acknowledge: bool = True, timeout: float = 120.0) -> Message:
        header, arrays = unpack(self.socket.recv(timeout=timeout))
        assert header["sequence"] == self.sequence + 1
        self.sequence += 1
        if acknowledge:
            self.acknowledge()
        return header, arrays

    def acknowledge(self) -> None:
        self.send("ack", sequence=self.sequence)

    def until(self, *kinds: str) -> list[Message]:
        """Messages up to the first of these kinds."""
        found = [self.receive()]
        while found[-1][0]["kind"] not in kinds:
            found.append(self.receive())
        return found

    def ran(self, config: object) -> list[Message]:
        """All messages of a run."""
        self.send("run", config=config)
        return self.until("done", "failed", "mistakes")


def only(messages: Sequence[Message], kind: str) -> Message:
    """The one message of a kind."""
    (found,) = (message for message in messages if message[0]["kind"] == kind)
    return found


def column(messages: Sequence[Message], name: str) -> list[float]:
    """A column of all rows."""
    at = only(messages, "scene")[0]["columns"].index(name)
    return [
        row[at] for header, arrays in messages if header["kind"] == "rows" for row in arrays["rows"].tolist()
    ]


def heights_of(message: Message) -> Any:
    """The heights of a scene."""
    low, high = message[0]["height_range"]
    return low + (high - low) * message[1]["heights"] / 65535


def maps(messages: Sequence[Message]) -> dict[int, tuple[Header, Any, Any]]:
    """Facts, contact and pressures of all maps."""
    found, shape = {}, only(messages, "scene")[0]["shape"]
    for header, arrays in messages:
        for one in header["maps"] if header["kind"] == "rows" else ():
            bits, pressure = (arrays[f"{name}.{one['index']}"] for name in ("bits", "pressure"))
            found[one["index"]] = one, np.unpackbits(bits).reshape(shape), pressure
    return found


@pytest.fixture(scope="session")
def results_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a run and, deeper, a campaign; and a link that leads out of it."""
    root = tmp_path_factory.mktemp("served")
    words = ("--shape", "24", "24", "--last", "10", "--load", "12", "--seed", "7", "--quiet", "--figures", "")
    assert main(["run", *words, "--out", str(root / "results" / "a run")]) == 0
    from asperity.app.campaign import read_plan

    (root / "results" / "deeper").mkdir()
    do_here(read_plan(written(root, SWEPT)), root / "results" / "deeper" / "campaign")
    shutil.copytree(root / "results" / "a run", root / "outside")
    (root / "results" / "link").symlink_to(root / "outside")
    return root / "results"


@pytest.fixture(scope="session")
def server(results_folder: Path) -> Iterator[Server]:
    """A server of that folder, for tests that leave it working."""
    pytest.importorskip("uvicorn", reason="needs the extra explore")
    running = Server(results_folder)
    assert running.port
    yield running
    if running.process.poll() is None:
        running.end()
