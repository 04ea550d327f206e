"""The server of the page: on this machine alone, for pages of its own alone.

A browser lets any page send requests to 127.0.0.1. So the host that a request names must be this machine
(another name may have been pointed here), and what changes something must come from our own page (Origin).
The port that it names is that of the browser's machine, of which a tunnel makes another one here.
"""

from __future__ import annotations

import asyncio
import contextlib
import hashlib
import json
import logging
import mimetypes
import re
import socket
import tempfile
import webbrowser
from collections.abc import AsyncIterator, Callable
from dataclasses import asdict
from pathlib import Path
from typing import Any

import uvicorn
from starlette.applications import Starlette
from starlette.datastructures import Headers
from starlette.requests import ClientDisconnect, Request
from starlette.responses import JSONResponse, Response
from starlette.routing import Mount, Route, WebSocketRoute
from starlette.staticfiles import StaticFiles
from starlette.types import ASGIApp, Receive, Scope, Send
from starlette.websockets import WebSocket, WebSocketClose, WebSocketDisconnect

from asperity.app.config import RunConfig, config_from
from asperity.app.config.keys import keys_of, sections
from asperity.app.config.mistakes import Door
from asperity.app.config.reading import question_of
from asperity.app.explore.export import exported_page
from asperity.app.explore.folders import Opened, entries, open_entry
from asperity.app.explore.jobs import Job, Jobs
from asperity.app.explore.mistakes import Shown, failed, mistake, mistakes_of
from asperity.app.explore.scene import Arrays, Cursor, Header, Recording, pack
from asperity.ask.questions import QUESTIONS, question_named
from asperity.ask.run import FILES
from asperity.ask.section import KINDS
from asperity.base.files import without_links
from asperity.errors import ConfigError, InputError, brief

HOST = "127.0.0.1"
USUAL_PORT, _PORTS = 8765, 20
"""Port that is tried first, and how many are tried."""

PER_DECADE = 8
"""Default number of times per decade: twice that of the command line."""

_LONGEST_CHECK, _LONGEST_UPLOAD = 30.0, 600.0
"""Seconds after which the check of a configuration, or an upload, is stopped."""

_LARGEST_FILE, _LARGEST_FILES = 200_000_000, 1_000_000_000
"""Most bytes of one uploaded file, and of all."""

_OWN_HOST = re.compile(r"(localhost|127\.0\.0\.1|\[::1\])(:\d{1,5})?", re.IGNORECASE)

_LARGEST_REQUEST = 2**20
"""Bytes of a message of a page."""

_POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; "
    "media-src blob:; connect-src 'self' ws://{host}; base-uri 'none'; form-action 'none'; "
    "frame-ancestors 'none'"
)


class Places:
    """The folder that is shown, and the dropped files, each in a folder named by the hash of its content."""

    def __init__(self, root: Path | None, uploads: Path) -> None:
        self.root, self.uploads = root, uploads.resolve()
        self._named: set[Path] = set()

    def allow(self, config: RunConfig | None) -> None:
        """Allow the surface file of an opened run."""
        if config is not None and config.surface.file is not None:
            self._named.add(config.surface.file.resolve())

    def find(self, name: str) -> Path:
        """The file of a name: in the folder, among the dropped ones, or of a run that was opened.

        `InputError` if it lies elsewhere.
        """
        homes = [home.resolve() for home in (self.root, self.uploads) if home is not None]
        with contextlib.suppress(ValueError):  # a name that no disk has, or links in a circle
            for place in (without_links(home / name) for home in homes):
                if place.is_file() and (place in self._named or any(map(place.is_relative_to, homes))):
                    return place
        expected = "a file that was dropped on the page, or lies in the folder that is shown"
        raise InputError("path", expected=expected, got=name, advice="dropping it on the page")


def read_request(tables: object, places: Places) -> tuple[RunConfig, Shown]:
    """Check a configuration from a page, in which null stands for an absent key.

    `ConfigError` with one line for each mistake.
    """
    if not isinstance(tables, dict):
        raise ConfigError(["expected the sections of a configuration"])
    contents: dict[str, Any] = {
        section: {key: one for key, one in table.items() if one is not None}
        if isinstance(table, dict)
        else table
        for section, table in tables.items()
        if table != []
    }
    aging = contents.setdefault("aging", {})
    asked = question_named(question_of(contents))
    if isinstance(aging, dict) and "times" not in aging and asked.uses("aging", "per_decade"):
        aging.setdefault("per_decade", PER_DECADE)
    shown: Shown = {}
    for section, key in FILES.items():
        table = contents.get(section)
        if isinstance(table, dict) and isinstance(name := table.get(key), str):
            try:
                place = places.find(name)
            except InputError as error:
                raise Door({}).refused([error.about(key, section, key)]) from None
            table[key] = str(place)
            told = place.name if place.is_relative_to(places.uploads) else name
            shown[table[key]] = name, told, f"{section}.{key}"
    return config_from(contents, {}, None), shown


class Session:
    """One connected page: the run that it shows, and the position in its messages.

    The next message is made when the last was acknowledged, of all that is new by then. So a slow page
    gets larger messages, and nothing queues up.
    """

    def __init__(self, websocket: WebSocket, server: Server) -> None:
        self._websocket, self._server = websocket, server
        self._pending: dict[str, tuple[Header, Arrays]] = {}
        self._job: Job | None = None
        self._recording: Recording | None = None
        self._cursor = Cursor()
        self._news, self._acknowledged = asyncio.Event(), asyncio.Event()
        self._sequence = 0
        self._opening: asyncio.Task[None] | None = None

    async def run(self) -> None:
        """Serve the page until it goes."""
        await self._websocket.accept()
        self._put(await asyncio.to_thread(self._server.hello))
        sender = asyncio.create_task(self._send())
        try:
            while True:
                message = json.loads(await self._websocket.receive_text())
                if isinstance(message, dict):
                    await self._take(message)
        except (WebSocketDisconnect, ValueError, RecursionError, KeyError):
            pass  # gone, or no page of ours
        finally:
            sender.cancel()
            self._leave(at_once=False)
            with contextlib.suppress(asyncio.CancelledError, RuntimeError, WebSocketDisconnect):
                await sender
            with contextlib.suppress(RuntimeError, WebSocketDisconnect):
                await self._websocket.close()

    async def _take(self, message: dict[str, Any]) -> None:
        kind = message.get("kind")
        if kind == "ack":
            if message.get("sequence") == self._sequence:
                self._acknowledged.set()
        elif kind == "run":
            await self._begin(message.get("config"))
        elif kind == "open":  # the last one counts, and the page is not kept waiting
            if self._opening is not None:
                self._opening.cancel()
            self._opening = asyncio.create_task(self._open(str(message.get("path"))))
        elif kind == "stop" and self._job is not None:
            job = self._leave(at_once=True)
            self._put({"job": job, **failed(mistake("stopped"))})

    async def _begin(self, tables: object) -> None:
        try:
            async with asyncio.timeout(_LONGEST_CHECK):
                config, shown = await asyncio.to_thread(read_request, tables, self._server.places)
        except TimeoutError:
            text = f"checking took more than {_LONGEST_CHECK:g} s; try a smaller table, or a shorter history"
            self._put({"kind": "mistakes", "job": "", "mistakes": mistake(text)})
        except Exception as error:  # said to the user, in the page
            self._put({"kind": "mistakes", "job": "", "mistakes": mistakes_of(error)})
        else:
            if self._opening is not None:
                self._opening.cancel()
            self._watch(self._server.jobs.ask(config, shown, _title(config)))

    async def _open(self, path: str) -> None:
        try:
            opened = await self._server.open(path)
        except Exception as error:  # said to the user, in the page
            self._put({"job": path, **failed([one | {"where": ""} for one in mistakes_of(error)])})
            return
        self._leave(at_once=True)
        if opened.campaign is not None:
            self._put(*opened.campaign)
        self._recording, self._cursor = opened.recording, Cursor()
        self._news.set()

    def _watch(self, job: Job) -> None:
        job.watchers.add(self._news.set)
        if self._job is not job:
            self._leave(at_once=True)
        self._job, self._recording, self._cursor = job, job.recording, Cursor()
        self._news.set()

    def _leave(self, *, at_once: bool) -> str:
        job, self._job, self._recording = self._job, None, None
        if job is None:
            return ""
        self._server.jobs.leave(job, self._news.set, at_once=at_once)
        return job.recording.job

    def _put(self, header: Header, arrays: Arrays | None = None) -> None:
        self._pending[str(header["kind"])] = header, arrays or {}
        self._news.set()

    def _next(self) -> tuple[Header, Arrays] | None:
        if self._pending:
            return self._pending.pop(next(iter(self._pending)))
        return None if self._recording is None else self._recording.next(self._cursor)

    async def _send(self) -> None:
        """Send new messages; an error ends the connection, so that the page does not wait for ever."""
        try:
            while True:
                if (message := self._next()) is None:
                    self._news.clear()
                    await self._news.wait()
                    continue
                header, arrays = message
                self._sequence += 1
                self._acknowledged.clear()
                await self._websocket.send_bytes(pack({**header, "sequence": self._sequence}, arrays))
                await self._acknowledged.wait()
        except Exception:
            with contextlib.suppress(RuntimeError, WebSocketDisconnect):
                await self._websocket.close(1011)
            raise


class Server:
    """The application, and the files and runs of all its pages."""

    def __init__(self, root: Path | None, uploads: Path) -> None:
        mimetypes.add_type("text/javascript", ".js")  # some systems have another, which browsers refuse
        self.places = Places(root, uploads)
        self.jobs: Jobs
        self.app = Starlette(
            routes=[
                WebSocketRoute("/socket", self._socket),
                Route("/files/{name}", self._take_file, methods=["POST"]),
                Route("/shell.html", self._shell),
                Mount("/", StaticFiles(packages=[("asperity.app.explore", "page")], html=True)),
            ],
            lifespan=self._lifespan,
        )

    @contextlib.asynccontextmanager
    async def _lifespan(self, _: Starlette) -> AsyncIterator[None]:
        self.jobs = Jobs()
        await self.jobs.warm()
        try:
            yield
        finally:
            await self.jobs.close()

    def hello(self) -> Header:
        """The first message to a page."""
        form = {
            section: {kind: {name: asdict(key) for name, key in keys.items()} for kind, keys in kinds.items()}
            for section, kinds in sections(short=True).items()
        }
        form["aging"][""]["per_decade"]["default"] = PER_DECADE
        root = self.places.root
        questions = {
            name: {
                "keys": {key: asdict(one) for key, one in keys_of(KINDS[name][""].keys).items()},
                "unused": {section: [*keys] for section, keys in asked.unused.items()},
                "refused": [".".join(path) for path in asked.refused],
            }
            for name, asked in QUESTIONS.items()
        }
        folder = None if root is None else entries(root)
        return {"kind": "hello", "form": form, "questions": questions, "folder": folder}

    async def open(self, path: str) -> Opened:
        """Open what the folder holds."""
        if self.places.root is None:
            raise InputError("path", expected="a server that shows a folder", got=path)
        opened = await asyncio.to_thread(open_entry, self.places.root, path)
        self.places.allow(opened.config)
        return opened

    async def _socket(self, websocket: WebSocket) -> None:
        await Session(websocket, self).run()

    async def _shell(self, _: Request) -> Response:
        """The page for export, to which the browser adds the recording."""
        return Response(exported_page([], title="Asperity"), media_type="text/html")

    async def _take_file(self, request: Request) -> Response:
        name, uploads = request.path_params["name"], self.places.uploads
        if name in (".", "..") or set(name) & set("/\\\0"):
            return _refused(f"expected the name of a file, got {name!r}", 400)
        size, digest = 0, hashlib.sha256()
        try:
            kept = sum(one.stat().st_size for one in uploads.glob("[!.]*/*"))
            # A name of its own: that of the file may be as long as the disk allows.
            with tempfile.TemporaryDirectory(prefix=".", dir=uploads) as folder:
                part = Path(folder) / "part"
                async with asyncio.timeout(_LONGEST_UPLOAD):
                    with part.open("wb") as stream:
                        async for chunk in request.stream():
                            size += len(chunk)
                            if size > _LARGEST_FILE or kept + size > _LARGEST_FILES:
                                text = f"{name}: expected {_LARGEST_FILE // 10**6} MB at most"
                                return _refused(f"{text}, {_LARGEST_FILES // 10**6} MB of all files", 413)
                            stream.write(chunk)
                            digest.update(chunk)
                place = uploads / digest.hexdigest()[:16] / name
                place.parent.mkdir(exist_ok=True)
                part.replace(place)
        except ClientDisconnect:
            return _refused(f"{name}: the connection ended before the file did", 400)
        except OSError as error:
            return _refused(f"{brief(name, 80)}: {error.strerror or 'the file did not come to its end'}", 400)
        return JSONResponse({"path": place.relative_to(uploads).as_posix()})


def _refused(text: str, status: int) -> Response:
    return JSONResponse({"mistakes": mistake(text, "surface.path")}, status)


def _title(config: RunConfig) -> str:
    surface = config.surface
    sites = "" if surface.lattice is None else f", {' x '.join(map(str, surface.lattice))}"
    named = surface.file.name if surface.file else surface.kind.replace("_", " ")
    asked = f"{config.asked}: " if config.asked else ""
    return f"{asked}{named}{sites} on a {config.solid.kind.replace('_', ' ')}"


class OwnPagesOnly:
    """Refuse requests that name another host or come from another page, and tell browsers to be strict."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Check a request, and hand it on."""
        if scope["type"] not in ("http", "websocket"):
            await self._app(scope, receive, send)
            return
        hosts, origins = map(Headers(scope=scope).getlist, ("host", "origin"))
        host = hosts[0] if len(hosts) == 1 else ""  # one of each: of two nobody can say which counts
        changes = scope["type"] == "websocket" or scope["method"] not in ("GET", "HEAD")
        own = origins == [f"http://{host}"] or (not origins and not changes)
        if not _OWN_HOST.fullmatch(host) or not own:
            text = "asperity explore serves its own page alone, at localhost or 127.0.0.1"
            refusal = WebSocketClose(1008) if scope["type"] == "websocket" else Response(text, 403)
            await refusal(scope, receive, send)
            return

        async def send_strictly(message: Any) -> None:
            if message["type"] == "http.response.start":
                message["headers"] = [
                    *message["headers"],
                    (b"content-security-policy", _POLICY.format(host=host).encode()),
                    (b"x-content-type-options", b"nosniff"),
                    (b"referrer-policy", b"no-referrer"),
                    (b"cross-origin-resource-policy", b"same-origin"),
                    (b"cache-control", b"no-store"),
                ]
            await send(message)

        await self._app(scope, receive, send_strictly)


def free_socket(port: int | None) -> socket.socket:
    """Take a port of this machine: that one, or the next free one after the usual; else `InputError`."""
    for number in [port] if port is not None else [*range(USUAL_PORT, USUAL_PORT + _PORTS), 0]:
        taken = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
        taken.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            taken.bind((HOST, number))
            taken.listen()  # from now on: a browser that is quicker than the server waits
        except OSError as error:
            taken.close()
            reason = error.strerror or str(error)
        else:
            return taken
    got = f"{port}: {reason}" if port is not None else reason
    raise InputError("--port", expected="a free port", got=got, advice="another one, or none")


class _QuietlyEnding(uvicorn.Server):
    async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
        """Cut off connections that do not end in time: no error, whatever they were at."""
        logging.getLogger("uvicorn.error").setLevel(logging.CRITICAL)
        await super().shutdown(sockets)


def serve(root: Path | None, *, port: int | None, tell: Callable[[str], None], browser: bool) -> None:
    """Serve the page, with a folder if any, until the process is interrupted.

    The port is a free one by default; the address is told, and opened in a browser if wanted.
    """
    listening = free_socket(port)
    address = f"http://{HOST}:{listening.getsockname()[1]}/"
    with tempfile.TemporaryDirectory(prefix="asperity-") as uploads:
        settings = uvicorn.Config(
            OwnPagesOnly(Server(root, Path(uploads)).app),
            log_level="error",
            lifespan="on",
            ws="websockets-sansio",
            proxy_headers=False,
            ws_max_size=_LARGEST_REQUEST,
            ws_per_message_deflate=False,
            timeout_graceful_shutdown=1,
        )
        server = _QuietlyEnding(settings)
        tell(address)
        if browser:
            webbrowser.open(address)
        with contextlib.suppress(KeyboardInterrupt):
            server.run(sockets=[listening])
