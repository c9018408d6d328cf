"""Viser's server behind a guard: what reaches it has shown the token, the host and the origin."""

from __future__ import annotations

import contextlib
import io
import json
import socket
import threading
import time
import types
from collections.abc import Awaitable, Callable, Iterator
from http import HTTPStatus
from typing import Any

from standoff.errors import StandoffError, of_extra
from standoff.view.access import Access, Allowance, message_fault, value_fault
from standoff.view.tolerances import MAX_MESSAGE, MAX_PAGES

with of_extra("", "view"):
    import msgspec
    import viser as viser
    import websockets
    import websockets.asyncio.server
    from viser import _messages, infra
    from websockets.datastructures import Headers
    from websockets.http11 import Request, Response

POLICY = "; ".join(
    (
        "default-src 'none'",
        # Viser's client unpacks itself from its one file, with zstandard in WebAssembly, and
        # speaks to its server from a worker made of a blob.
        "script-src 'unsafe-inline' 'unsafe-eval' blob:",
        "worker-src blob:",
        "style-src 'unsafe-inline'",
        "img-src data: blob:",
        "font-src data:",
        "connect-src 'self' {socket} data: blob:",
        "base-uri 'none'",
        "form-action 'none'",
    )
)
"""What a browser lets the page load: nothing but the page itself and its own socket."""

POLICY_VIOLATION = 1008
"""Code that closes a socket whose messages are refused."""

TRY_AGAIN = 1013
"""Code that closes a socket where there are too many."""

VISERS: Any = infra.WebsockServer

_making = threading.Lock()


class GuardedServer(VISERS):  # type: ignore[misc]
    """Viser's server of messages, each connection checked before viser sees it.

    Attributes
    ----------
    access : Access
    guarded : bool
        Whether the guard stands before the port.
    refused : list of str
        Why requests and messages were refused; the last ones.
    """

    access: Access
    guarded: bool
    value_fault: Callable[[str, Any], str | None] = staticmethod(lambda uuid, value: None)
    """Why an element of the page, by its identifier, is not set to a value; None where it is."""

    def __init__(self, *given: Any, **named: Any) -> None:
        super().__init__(*given, **named)
        self.guarded = False
        self.fault: Exception | None = None
        self.refused: list[str] = []

    def start(self) -> None:
        """Start the server.

        Raises StandoffError if its thread ended, or opened the port past the guard; the port is
        closed then.
        """
        super().start()
        if self.guarded and self.fault is None:
            return
        self.stop()
        raise StandoffError(
            f"viser {viser.__version__} opens its port in a way that is not known here, so it "
            "cannot be guarded; install one of the versions that the extra 'view' asks for."
        ) from self.fault

    def note(self, reason: str) -> None:
        """Keep why something was refused; of many the last ones."""
        self.refused = [*self.refused[-99:], reason]

    def _background_worker(self, ready_sem: threading.Semaphore) -> None:
        # Viser's own function, but that the name `websockets` in it means ours: the port is opened
        # by `serve` below, and no other program's `websockets` is changed.
        theirs = VISERS._background_worker
        known = {**theirs.__globals__, "websockets": _Websockets(self)}
        bound = types.FunctionType(
            theirs.__code__, known, theirs.__name__, theirs.__defaults__, theirs.__closure__
        )
        try:
            bound(self, ready_sem)
        except Exception as error:
            # Viser's `start` waits for this, and would for ever.
            self.fault = error
            ready_sem.release()

    def serve(self, handler: Any, host: str, port: int, **options: Any) -> Any:
        """Open the port as viser does, with the guard before it.

        Parameters
        ----------
        handler : coroutine function
            Viser's own, of a connection.
        host : str
        port : int
        **options
            Of ``websockets.asyncio.server.serve``.
        """
        self.guarded = True
        pages = options.pop("process_request")
        connection = type("Connection", (_Connection,), {"guard": self})
        options |= {"max_size": MAX_MESSAGE, "server_header": None, "close_timeout": 1.0}
        return websockets.asyncio.server.serve(
            self._bounded(handler),
            host,
            port,
            process_request=lambda connection, request: self._answer(connection, request, pages),
            create_connection=connection,
            **options,
        )

    def _bounded(self, handler: Callable[[Any], Awaitable[None]]) -> Callable[[Any], Any]:
        async def handle(connection: Any) -> None:
            if len(self._live_connections) >= MAX_PAGES:
                self.note("too many pages are open")
                await connection.close(TRY_AGAIN, f"{MAX_PAGES} pages are open: close one")
                return
            await handler(connection)

        return handle

    def _answer(self, connection: Any, request: Request, pages: Any) -> Response | None:
        port = connection.local_address[1]
        reason = self.access.refusal(request.path, request.headers, port)
        if reason is not None:
            self.note(reason)
            text = f"Refused: {reason}.\n".encode()
            headers = Headers({"Content-Type": "text/plain; charset=utf-8"})
            headers["Content-Length"] = str(len(text))
            headers["Connection"] = "close"
            return Response(HTTPStatus.FORBIDDEN, "Forbidden", headers, text)
        request.path = "/"
        found: Response | None = pages(connection, request)
        if found is not None:
            (host,) = request.headers.get_all("Host")
            found.headers["Content-Security-Policy"] = POLICY.format(socket=f"ws://{host}")
            found.headers["Referrer-Policy"] = "no-referrer"
            found.headers["X-Content-Type-Options"] = "nosniff"
            found.headers["Cache-Control"] = "no-store"
        return found


class _Connection(websockets.asyncio.server.ServerConnection):
    """One page's socket: its messages are read here first."""

    guard: GuardedServer

    def __init__(self, *given: Any, **named: Any) -> None:
        super().__init__(*given, **named)
        self._allowance = Allowance()

    async def recv(self, decode: bool | None = None) -> Any:
        raw = await super().recv(decode)
        fault = self._fault(raw)
        if fault is None:
            return raw
        self.guard.note(fault)
        await self.close(POLICY_VIOLATION, fault)
        raise self.protocol.close_exc

    def _fault(self, raw: Any) -> str | None:
        if not self._allowance.take(time.monotonic()):
            return "too many messages"
        if not isinstance(raw, bytes):
            return "the message is a text"
        try:
            message = msgspec.msgpack.decode(raw)
        except (msgspec.DecodeError, RecursionError):
            return "the message is cut or damaged"
        fault = message_fault(message)
        if fault is None and message["type"] == "GuiUpdateMessage":
            fault = self.guard.value_fault(message.get("uuid", ""), message["updates"]["value"])
        return fault


class _Websockets(types.ModuleType):
    """The module `websockets` as viser's server sees it: only `asyncio.server.serve` is another."""

    def __init__(self, server: GuardedServer) -> None:
        super().__init__("websockets")
        inner = types.SimpleNamespace(**vars(websockets.asyncio.server))
        inner.serve = server.serve
        self.asyncio = types.SimpleNamespace(server=inner)

    def __getattr__(self, name: str) -> Any:
        return getattr(websockets, name)


def guarded_server(access: Access, port: int | None = None) -> viser.ViserServer:
    """Return a running server of viser's, with the guard before its port.

    Raises StandoffError if the port or the host is not available; if this viser opens its port in
    another way than those for which the guard was made, and is stopped at once.

    Parameters
    ----------
    access : Access
    port : int, optional
        If not given, any that is free.
    """
    check_free(access.host, port or 0)
    kind = type("GuardedServer", (GuardedServer,), {"access": access})
    with made_by(kind):
        server = viser.ViserServer(host=access.host, port=port or 0, verbose=False)
    if not isinstance(server._websock_server, GuardedServer):
        stop(server)
        raise StandoffError(
            f"viser {viser.__version__} makes its server in a way that is not known here, so it "
            "cannot be guarded; install one of the versions that the extra 'view' asks for."
        )
    elements = server.gui._gui_input_handle_from_uuid

    def fault(uuid: str, value: Any) -> str | None:
        element: Any = elements.get(uuid)  # viser ignores what is no longer there
        if element is None:
            return None
        return value_fault(value, element.value, getattr(element, "options", None))

    server._websock_server.value_fault = fault
    return server


def name_tab(server: viser.ViserServer, title: str) -> None:
    """Put a title on the browser's tab of every page, including those that are opened later."""
    # Viser has no word for it. As JSON the title is a text to the browser, whatever it holds.
    source = f"document.title = {json.dumps(title)};"
    server._websock_server.queue_message(_messages.RunJavascriptMessage(source))


def check_free(host: str, port: int) -> None:
    """Refuse a host that does not belong to this machine, or a port that is in use.

    Raises StandoffError.
    """
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    try:
        with socket.socket(family) as probe:
            probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            probe.bind((host, port))
    except (OSError, OverflowError) as error:
        raise StandoffError(
            f"{host}:{port} is not available ({getattr(error, 'strerror', None) or error}): name "
            "another port, or none for any that is free; a host must be one of this machine's.",
            "port",
            port,
        ) from error


def stop(server: viser.ViserServer) -> None:
    """Close the port and end the server's threads."""
    with contextlib.redirect_stdout(io.StringIO()):
        server.stop()


@contextlib.contextmanager
def made_by(kind: type) -> Iterator[None]:
    """While viser makes a server: of this kind, and without a message about an address without a
    token."""
    with _making, contextlib.redirect_stdout(io.StringIO()):
        infra.WebsockServer = kind
        try:
            yield
        finally:
            infra.WebsockServer = VISERS
