"""Take docs/images/live-world.png: the live page of examples/shelves.toml in Chromium.

Run: python docs/images/make_live_world_picture.py [FILE].
Needs the extra `view`, playwright and Chromium.
"""

import shutil
import sys
from pathlib import Path

from playwright.sync_api import sync_playwright

import standoff as so

HERE = Path(__file__).parent
SHELVES = HERE.parents[1] / "examples" / "shelves.toml"
TIME = 0.97  # s
WINDOW = {"width": 1280, "height": 860}
OPTIONS = [
    "--no-sandbox",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
]


def main() -> None:
    target = Path(sys.argv[1]) if len(sys.argv) > 1 else HERE / "live-world.png"
    chromium = shutil.which("chromium") or shutil.which("chromium-browser")
    with so.view(SHELVES, open=False) as page, sync_playwright() as running:
        page.stage.hand(None)
        page.stage.seek(TIME)
        browser = running.chromium.launch(executable_path=chromium, args=OPTIONS)
        tab = browser.new_page(viewport=WINDOW)
        tab.goto(page.address)
        tab.get_by_role("tab", name="Matrix").click(timeout=60_000)
        (client,) = page.server.get_clients().values()
        client.camera.position = (0.55, -2.05, 1.6)
        client.camera.look_at = (1.15, 0.05, 0.55)
        tab.wait_for_timeout(12_000)  # drawn without a graphics card
        tab.evaluate(
            "document.querySelectorAll('[role=alert]').forEach(e => e.style.display = 'none')"
        )
        tab.screenshot(path=target)
        browser.close()


if __name__ == "__main__":
    main()
