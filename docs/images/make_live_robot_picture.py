"""Take docs/images/live-robot.png: examples/robots/arm.xml on a proven path, in Chromium.

Run: python docs/images/make_live_robot_picture.py [FILE].
Needs the extras `view`, `mujoco` and `plot`, playwright and Chromium.
"""

import shutil
import sys
from pathlib import Path

from playwright.sync_api import sync_playwright

import standoff as so

HERE = Path(__file__).parent
ARM = HERE.parents[1] / "examples" / "robots" / "arm.xml"
# As in docs/certify.md.
PATH = [
    [-0.9, 0.6, 0.0, 0.5, 0.0, 0.3, 0.0],
    [-1.45, -0.8, 0.0, -0.5, 0.0, 0.1, 0.0],
    [-2.0, 0.6, 0.0, 0.5, 0.0, 0.3, 0.0],
]
TIME = 1.9  # s
WINDOW = {"width": 1180, "height": 1000}
OPTIONS = [
    "--no-sandbox",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
]


def main() -> None:
    target = Path(sys.argv[1]) if len(sys.argv) > 1 else HERE / "live-robot.png"
    chromium = shutil.which("chromium") or shutil.which("chromium-browser")
    robot = so.Robot.from_mujoco(ARM, within=0.3)
    proof = robot.certify(PATH, 5e-3)
    with robot.view(PATH, proof=proof, open=False) as page, sync_playwright() as running:
        page.seek(TIME)
        browser = running.chromium.launch(executable_path=chromium, args=OPTIONS)
        tab = browser.new_page(viewport=WINDOW)
        tab.goto(page.address)
        tab.locator("[data-of=proof] img").wait_for(timeout=60_000)
        (client,) = page.server.get_clients().values()
        client.camera.position = (2.3, -2.1, 1.6)
        client.camera.look_at = (0.45, 0.35, 0.4)
        tab.wait_for_timeout(8_000)  # drawn without a graphics card
        tab.evaluate(
            "document.querySelectorAll('[role=alert]').forEach(e => e.style.display = 'none')"
        )
        tab.screenshot(path=target)
        browser.close()


if __name__ == "__main__":
    main()
