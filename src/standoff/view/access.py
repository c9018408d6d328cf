"""Who may talk to a live page, and with which messages.

Any web page in a user's browser can reach a port of the user's own machine, and a name that is
looked up twice can lead a browser to it under another origin (DNS rebinding). So each request must
carry the token of this run, name the page's own host, and, on a socket, come from the page itself.
"""

from __future__ import annotations

import hmac
import ipaddress
import math
import secrets
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Protocol
from urllib.parse import urlsplit

from standoff.kernels.tolerances import FARTHEST
from standoff.motion.tolerances import UNIT_QUATERNION
from standoff.view.tolerances import (
    MAX_DEPTH,
    MAX_TEXT,
    MESSAGE_BURST,
    MESSAGE_RATE,
)

LOCAL = ("127.0.0.1", "localhost", "::1")
"""Names of the machine itself, of which the browser may use any for a page bound to one."""

ANYWHERE = ("0.0.0.0", "::")
"""Hosts that bind to all of the machine's addresses."""

TOKEN_BYTES = 24
"""Of a token: 192 bits, more than anyone can try."""

TYPES = frozenset(
    {
        "ViewerCameraMessage",
        "GuiUpdateMessage",
        "GuiFormDirtyMessage",
        "TransformControlsDragStartMessage",
        "TransformControlsUpdateMessage",
        "TransformControlsDragEndMessage",
    }
)
"""Messages that a page sends here. Viser's others are for what this page does not have: uploads,
commands, and a tunnel to another host that shares the page."""


class Headers(Protocol):
    """The part of a request's headers that is read here."""

    def get_all(self, key: str, /) -> list[str]:
        """All values of a header; none where it is not there."""


@dataclass(frozen=True)
class Access:
    """What a request to one run's page must show.

    Parameters
    ----------
    host : str
        Name or address that the page is bound to.
    token : str
        Of this run; in the path of the page's address.
    """

    host: str = "127.0.0.1"
    token: str = field(default_factory=lambda: secrets.token_urlsafe(TOKEN_BYTES), repr=False)

    def address(self, port: int) -> str:
        """Return the page's address, with its token.

        Parameters
        ----------
        port : int

        Returns
        -------
        str
        """
        host = "127.0.0.1" if self.host in ANYWHERE else self.host
        return f"http://{f'[{host}]' if ':' in host else host}:{port}/{self.token}/"

    def refusal(self, path: str, headers: Headers, port: int) -> str | None:
        """Return why a request is refused; None where it may pass.

        Parameters
        ----------
        path : str
            As the request has it.
        headers : Headers
        port : int
            That the page is bound to.
        """
        hosts = headers.get_all("Host")
        if len(hosts) != 1 or not self._own(hosts[0], port):
            return "the request names another host than this page's"
        origins = headers.get_all("Origin")
        socket = bool(headers.get_all("Upgrade"))
        if (socket or origins) and origins != [f"http://{hosts[0]}"]:
            return "the request comes from another page"
        given = path.partition("?")[0].strip("/").encode("utf-8", "replace")
        if not hmac.compare_digest(given, self.token.encode()):
            return "the address lacks the token of this run: open the one that was printed"
        return None

    def _own(self, host: str, port: int) -> bool:
        """Is this `Host` header one of the page's own?"""
        try:
            parts = urlsplit(f"//{host}")
            name, given = parts.hostname or "", parts.port or 80
        except ValueError:
            return False
        if given != port or parts.username is not None:
            return False
        if self.host in ANYWHERE:
            # An address in numbers is looked up nowhere, so none can be put in its place.
            return name in LOCAL or _is_address(name)
        return name == self.host.lower() or (self.host in LOCAL and name in LOCAL)


def _is_address(name: str) -> bool:
    try:
        ipaddress.ip_address(name)
    except ValueError:
        return False
    return True


@dataclass
class Allowance:
    """How many messages one page may still send: `MESSAGE_RATE` a second, `MESSAGE_BURST` at once.

    Attributes
    ----------
    left : float
        Messages that may be sent now.
    at : float
        When that was so [s]; nan before the first.
    """

    left: float = MESSAGE_BURST
    at: float = math.nan

    def take(self, now: float) -> bool:
        """Count one message at a time [s]; return whether it is still allowed."""
        waited = 0.0 if math.isnan(self.at) else max(0.0, now - self.at)
        self.left = min(MESSAGE_BURST, self.left + MESSAGE_RATE * waited)
        self.at = now
        if self.left < 1.0:
            return False
        self.left -= 1.0
        return True


def message_fault(message: Any) -> str | None:
    """Return why a message of a page is refused; None where it may pass.

    Viser writes whatever an update names into its own handle of that element, so only values pass,
    and only plain finite ones.

    Parameters
    ----------
    message : object
        As it was unpacked: a mapping with a `type`.
    """
    if not isinstance(message, Mapping):
        return "the message is not a mapping"
    kind = message.get("type")
    if not isinstance(kind, str) or kind not in TYPES:
        return "the message is of a kind that this page does not send"
    if not _plain(message, MAX_DEPTH):
        return "the message holds something that is neither a short text nor a finite number"
    if not all(isinstance(message.get(key, ""), str) for key in ("name", "owner", "uuid")):
        return "the message names what it changes by something that is not text"
    if kind == "GuiUpdateMessage":
        updates = message.get("updates")
        if not isinstance(updates, Mapping) or set(updates) != {"value"}:
            return "the message changes more of an element than its value"
    if kind == "TransformControlsUpdateMessage":
        return _pose_fault(message.get("wxyz"), message.get("position"))
    return None


def value_fault(value: Any, current: Any, options: Sequence[str] | None = None) -> str | None:
    """Return why a value is refused for an element of the page; None where it may be set.

    Viser would cast it: a string to a number, including NaN, and anything to a string.

    Parameters
    ----------
    value : object
        What the message gives.
    current : object
        The element's own value.
    options : sequence of str, optional
        Everything that the element can be set to, if that is a few choices.
    """
    number = isinstance(current, int | float) and not isinstance(current, bool)
    if number and (isinstance(value, bool) or not isinstance(value, int | float)):
        return "the message gives something other than a number for a number"
    if not number and type(value) is not type(current):
        return "the message gives a value of another kind than the present one"
    if options is not None and value not in options:
        return "the message gives a choice that the page does not have"
    return None


def _pose_fault(wxyz: Any, position: Any) -> str | None:
    """Is this the pose of a handle?"""
    for numbers, count in ((wxyz, 4), (position, 3)):
        if not isinstance(numbers, list) or len(numbers) != count:
            return "the message gives no pose: four numbers and three"
        if any(isinstance(x, bool) or not isinstance(x, int | float) for x in numbers):
            return "the message gives no pose: one of its parts is not a number"
    if not abs(math.hypot(*wxyz) - 1.0) < UNIT_QUATERNION:
        return "the message gives no pose: its quaternion is not of length 1"
    if not math.hypot(*position) < FARTHEST:
        return "the message gives a pose too far away to be computed with"
    return None


def _plain(value: Any, depth: int) -> bool:
    """Are these finite numbers and short texts, nested no deeper than that?"""
    if value is None or isinstance(value, bool):
        return True
    if isinstance(value, int | float):
        return abs(value) < math.inf
    if isinstance(value, str):
        return len(value) <= MAX_TEXT
    if depth == 0:
        return False
    if isinstance(value, Mapping):
        return all(isinstance(key, str) and _plain(each, depth - 1) for key, each in value.items())
    return isinstance(value, list) and all(_plain(each, depth - 1) for each in value)
