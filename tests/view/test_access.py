"""Who may talk to the page: host, origin, token; and which messages pass."""

from __future__ import annotations

import math
from typing import Any

import pytest

from standoff.view.access import Access, Allowance, message_fault
from standoff.view.tolerances import MAX_TEXT, MESSAGE_BURST, MESSAGE_RATE

TOKEN = "a" * 32
PORT = 8123


class Given(dict[str, str]):
    """Headers, each once."""

    def get_all(self, key: str) -> list[str]:
        return [self[key]] if key in self else []


def refusal(host: str = "127.0.0.1", path: str = f"/{TOKEN}/", **headers: str) -> str | None:
    given = Given({"Host": f"127.0.0.1:{PORT}", **headers})
    return Access(host, TOKEN).refusal(path, given, PORT)


@pytest.mark.parametrize("name", ["127.0.0.1", "localhost", "[::1]", "LOCALHOST"])
def test_the_page_is_given_under_each_name_of_the_machine_itself(name: str) -> None:
    assert refusal(Host=f"{name}:{PORT}") is None
    socket = {"Upgrade": "websocket", "Origin": f"http://{name}:{PORT}"}
    assert refusal(path=f"/{TOKEN}", Host=f"{name}:{PORT}", **socket) is None


@pytest.mark.parametrize(
    "host",
    [
        *("evil.test", f"evil.test:{PORT}", f"127.0.0.1.evil.test:{PORT}", "127.0.0.1", ""),
        *(f"127.0.0.1:{PORT + 1}", f"x@127.0.0.1:{PORT}", "127.0.0.1:x", f"10.0.0.1:{PORT}"),
    ],
)
def test_another_host_is_refused(host: str) -> None:
    assert "another host" in (refusal(Host=host) or "")


@pytest.mark.parametrize(
    "origin", ["http://evil.test", "null", f"https://127.0.0.1:{PORT}", f"http://localhost:{PORT}"]
)
def test_a_foreign_origin_is_refused(origin: str) -> None:
    assert "another page" in (refusal(Origin=origin) or "")
    assert "another page" in (refusal(Upgrade="websocket", Origin=origin) or "")


def test_a_socket_without_an_origin_is_refused() -> None:
    assert "another page" in (refusal(Upgrade="websocket") or "")


@pytest.mark.parametrize("path", ["/", "", f"/{TOKEN[:-1]}/", f"/{TOKEN}b/", f"/x?{TOKEN}", "/ä"])
def test_a_wrong_token_is_refused(path: str) -> None:
    assert "token" in (refusal(path=path) or "")


def test_a_page_bound_everywhere_is_given_under_addresses_in_numbers_alone() -> None:
    assert refusal("0.0.0.0", Host=f"192.168.1.7:{PORT}") is None
    assert refusal("0.0.0.0", Host=f"[fe80::1]:{PORT}") is None
    assert "another host" in (refusal("0.0.0.0", Host=f"evil.test:{PORT}") or "")


def test_tokens_differ_and_are_not_shown() -> None:
    first, second = Access(), Access()
    assert first.token != second.token
    assert len(first.token) >= 32
    assert first.token not in repr(first)
    assert first.address(80) == f"http://127.0.0.1:80/{first.token}/"
    assert Access("::1", TOKEN).address(80) == f"http://[::1]:80/{TOKEN}/"


def test_messages_are_bounded_in_rate() -> None:
    allowance = Allowance()
    assert sum(allowance.take(5.0) for _ in range(10_000)) == MESSAGE_BURST
    assert sum(allowance.take(6.0) for _ in range(10_000)) == MESSAGE_RATE
    # A clock that goes backwards gives nothing.
    assert not allowance.take(1.0)


CAMERA = {"type": "ViewerCameraMessage", "wxyz": [1.0, 0.0, 0.0, 0.0], "fov": 0.8}
VALUE = {"type": "GuiUpdateMessage", "uuid": "x", "updates": {"value": 3}}


@pytest.mark.parametrize("message", [CAMERA, VALUE])
def test_what_a_page_sends_passes(message: Any) -> None:
    assert message_fault(message) is None


@pytest.mark.parametrize(
    "message",
    [
        *(None, [], "GuiUpdateMessage", {}, {"type": 3}, {"type": "Message"}),
        *({"type": "ShareUrlRequest"}, {"type": "FileTransferStartUpload"}),
        CAMERA | {"fov": math.nan},
        CAMERA | {"wxyz": [math.inf, 0.0, 0.0, 0.0]},
        CAMERA | {"wxyz": [[[[[1.0]]]]]},
        VALUE | {"uuid": "x" * (MAX_TEXT + 1)},
        VALUE | {"uuid": b"x"},
        VALUE | {"updates": {"value": 3, "update_cb": []}},
        VALUE | {"updates": {"max": 3}},
        VALUE | {"updates": 3},
    ],
)
def test_other_messages_are_refused(message: Any) -> None:
    assert message_fault(message) is not None
