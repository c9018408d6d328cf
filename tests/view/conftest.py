"""A headless browser, and pages in it whose requests are noted."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from typing import Any

import pytest
from browsing import ONE_THING

from waiting import LONG

ROOT = Path(__file__).parents[2]
SHOTS = ROOT / "build" / "view"

# Software rendering, and nothing that a browser does by itself on the net.
OPTIONS = [
    *("--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"),
    *("--disable-background-networking", "--disable-component-update", "--disable-sync"),
]


@pytest.fixture(scope="session")
def chromium() -> Iterator[Any]:
    pytest.importorskip("viser", reason="viser is not installed (extra 'view')")
    playwright = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
    path = shutil.which("chromium") or shutil.which("chromium-browser")
    if path is None:
        pytest.skip("chromium is not installed")
    with playwright.sync_playwright() as running:
        browser = running.chromium.launch(executable_path=path, args=OPTIONS)
        yield browser
        browser.close()


class Tab:
    """A page of the browser and what it asked for."""

    def __init__(self, browser: Any, width: int, height: int, scale: float = 1.0) -> None:
        size = {"width": width, "height": height}
        self.page = browser.new_page(viewport=size, device_scale_factor=scale)
        self.page.set_default_timeout(1000.0 * LONG)
        self.requests: list[str] = []
        self.failed: list[str] = []
        self.errors: list[str] = []
        self.page.on("request", lambda request: self.requests.append(request.url))
        self.page.on("websocket", lambda opened: self.requests.append(opened.url))
        self.page.on("requestfailed", lambda request: self.failed.append(request.url))
        self.page.on("pageerror", lambda error: self.errors.append(str(error)))
        self.page.on("console", self._console)

    def _console(self, message: Any) -> None:
        if message.type == "error":
            self.errors.append(message.text)

    def shown(self, name: str) -> str:
        """A value of the panel's table."""
        found: str = self.page.locator(f"[data-of={name}]").text_content()
        return found

    def number(self, name: str) -> float:
        return float(self.shown(name).split()[0])

    def shot(self, name: str) -> Path:
        """Keep a picture, without the browser's word on software rendering."""
        self.page.evaluate(
            "document.querySelectorAll('[role=alert]').forEach(e => e.style.display = 'none')"
        )
        SHOTS.mkdir(parents=True, exist_ok=True)
        file = SHOTS / f"{name}.png"
        self.page.screenshot(path=file)
        return file

    def foreign(self, address: str) -> list[str]:
        """Requests to anything but the page's own host."""
        own = address.split("//")[1].split("/")[0]
        return [
            url
            for url in self.requests
            if not url.removeprefix("blob:").split("//")[-1].startswith(f"{own}/")
        ]


@pytest.fixture
def tab(chromium: Any) -> Iterator[Any]:
    opened: list[Tab] = []

    def make(width: int, height: int, scale: float = 0.25) -> Tab:
        # A sixteenth of the pixels: they are drawn without a graphics card.
        opened.append(Tab(chromium, width, height, scale))
        return opened[-1]

    yield make
    for each in opened:
        each.page.close()


@pytest.fixture(autouse=True)
def one_thing(monkeypatch: pytest.MonkeyPatch) -> None:
    """Pages do one thing at a time, which `until` waits for."""
    try:
        served = import_module("standoff.view.served").ServedPage
    except ModuleNotFoundError:  # without the extra `view` there are no pages
        return
    attempt = served._attempt

    def alone(page: Any, task: Any) -> None:
        with ONE_THING:
            attempt(page, task)

    monkeypatch.setattr(served, "_attempt", alone)


@pytest.fixture
def slowly(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let a browser that draws without a graphics card keep up."""
    pytest.importorskip("viser", reason="viser is not installed (extra 'view')")
    monkeypatch.setattr(import_module("standoff.view.served"), "PERIOD", 0.15)
