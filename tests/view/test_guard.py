"""The port itself: what a browser, another page and another program get from it."""

from __future__ import annotations

import http.client
import socket
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import pytest

from standoff.errors import StandoffError
from standoff.scene import load_scene
from standoff.view.tolerances import MAX_MESSAGE, MAX_PAGES, MESSAGE_BURST
from waiting import LONG, until

pytest.importorskip("viser", reason="viser is not installed (extra 'view')")

import msgspec
import viser
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import ClientConnection, connect

from standoff.view.page import Page

EXAMPLES = Path(__file__).parents[2] / "examples"
VALUE = {"type": "GuiUpdateMessage", "uuid": "none", "updates": {"value": 1}}


@pytest.fixture(scope="module")
def page() -> Iterator[Page]:
    with Page(load_scene(EXAMPLES / "lenses.toml")) as page:
        yield page


def get(page: Page, path: str | None = None, **headers: str) -> http.client.HTTPResponse:
    connection = http.client.HTTPConnection("127.0.0.1", page.port, timeout=LONG)
    connection.request("GET", urlsplit(page.address).path if path is None else path, None, headers)
    return connection.getresponse()


def open_socket(page: Page, *, origin: str | None = "own", path: str | None = None) -> Any:
    here = f"127.0.0.1:{page.port}"
    given = urlsplit(page.address).path.rstrip("/") if path is None else path
    own = f"http://{here}" if origin == "own" else origin
    protocol = f"viser-v{viser.__version__}"
    return connect(f"ws://{here}{given}", origin=own, subprotocols=[protocol], close_timeout=0.1)


def send(connection: ClientConnection, message: Any) -> None:
    connection.send(msgspec.msgpack.encode(message))


def closing_code(connection: ClientConnection) -> int:
    """The code that a server closes with, all it sent read."""
    with suppress(ConnectionClosed):
        while True:
            connection.recv(timeout=LONG)
    assert connection.close_code is not None
    return connection.close_code


def test_the_page_is_given_with_a_policy_that_names_no_other_host(page: Page) -> None:
    answer = get(page)
    assert answer.status == 200
    policy = answer.headers["Content-Security-Policy"]
    assert policy.startswith("default-src 'none'")
    assert f"connect-src 'self' ws://127.0.0.1:{page.port} data: blob:" in policy
    assert "http" not in policy
    assert answer.headers["Referrer-Policy"] == "no-referrer"


@pytest.mark.parametrize("path", ["/", "/index.html", "/" + "x" * 32 + "/", "/../index.html"])
def test_without_the_token_nothing_is_given(page: Page, path: str) -> None:
    answer = get(page, path)
    assert answer.status == 403
    assert b"token" in answer.read()


def test_a_name_that_leads_here_from_elsewhere_is_refused(page: Page) -> None:
    answer = get(page, Host=f"evil.test:{page.port}")
    assert answer.status == 403
    assert b"another host" in answer.read()


@pytest.mark.parametrize(
    "given",
    [{"origin": "http://evil.test"}, {"origin": None}, {"path": "/"}, {"path": "/" + "x" * 32}],
)
def test_a_foreign_origin_or_a_wrong_token_opens_no_socket(
    page: Page, given: dict[str, Any]
) -> None:
    with pytest.raises(InvalidStatus) as caught:
        open_socket(page, **given)
    assert caught.value.response.status_code == 403


def test_a_rebound_name_opens_no_socket(page: Page) -> None:
    with socket.create_connection(("127.0.0.1", page.port)) as plain:
        uri = f"ws://evil.test:{page.port}{urlsplit(page.address).path}"
        with pytest.raises(InvalidStatus) as caught:
            connect(uri, sock=plain, origin=f"http://evil.test:{page.port}")
    assert caught.value.response.status_code == 403


def test_the_page_s_own_socket_is_sent_the_scene(page: Page) -> None:
    with open_socket(page) as connection:
        send(connection, VALUE)
        assert len(connection.recv(timeout=LONG)) > 1000


def test_a_message_too_long_closes_the_socket(page: Page) -> None:
    with open_socket(page) as connection:
        connection.send(b"\0" * (MAX_MESSAGE + 1))
        assert closing_code(connection) == 1009


@pytest.mark.parametrize("raw", [b"", b"\xc1", b"\x81", "a text", b"\x93" * 5000, b"\x00"])
def test_a_damaged_message_closes_the_socket(page: Page, raw: bytes | str) -> None:
    with open_socket(page) as connection:
        connection.send(raw)
        assert closing_code(connection) == 1008


def test_a_message_of_another_kind_closes_the_socket(page: Page) -> None:
    with open_socket(page) as connection:
        send(connection, {"type": "ShareUrlRequest"})
        assert closing_code(connection) == 1008
    assert page.server._share_tunnel is None


def test_too_many_messages_close_the_socket_and_no_other(page: Page) -> None:
    with open_socket(page) as other, open_socket(page) as connection:
        with suppress(ConnectionClosed):
            for _ in range(20 * int(MESSAGE_BURST)):
                send(connection, VALUE)
        assert closing_code(connection) == 1008
        assert "too many" in connection.close_reason
        send(other, VALUE)
        assert other.ping().wait(LONG)


def test_more_pages_than_allowed_are_refused(page: Page) -> None:
    # those of other tests are closing
    until(lambda: not page.server._websock_server._live_connections)
    opened = [open_socket(page) for _ in range(MAX_PAGES)]
    try:
        for each in opened:
            each.recv(timeout=LONG)
        with open_socket(page) as one_more:
            assert closing_code(one_more) == 1013
    finally:
        for each in opened:
            each.close()


def test_a_port_in_use_is_refused_with_what_to_do(page: Page) -> None:
    with pytest.raises(StandoffError, match="name another port"):
        Page(load_scene(EXAMPLES / "lenses.toml"), port=page.port)


@pytest.mark.parametrize(("host", "port"), [("203.0.113.1", 0), ("127.0.0.1", 70000)])
def test_a_host_or_port_that_cannot_be_had_is_refused(host: str, port: int) -> None:
    with pytest.raises(StandoffError, match="is not available"):
        Page(load_scene(EXAMPLES / "lenses.toml"), host=host, port=port)
