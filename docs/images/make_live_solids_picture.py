"""Take docs/images/live-solids.png: the live page of a bridge on a table in Chromium.

Run: python docs/images/make_live_solids_picture.py [FILE].
Needs the extra `view`, playwright and Chromium.
"""

import shutil
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
from playwright.sync_api import sync_playwright

import standoff as so
from standoff.bodies import Edge, Face
from standoff.geometry import Line, Plane
from standoff.solids import Solid, save_boundary

HERE = Path(__file__).parent
OUTLINE = [(-30, -20), (-20, -20), (-20, -10), (20, -10), (20, -20), (30, -20), (30, 0), (-30, 0)]
THICK = 24.0  # mm
SCENE = """
version = 1
title = "A bridge on a table"
length_unit = "mm"
[bodies.bridge]
body = "bridge.json"
[bodies.table]
shape = "box"
size = [90.0, 50.0, 8.0]
[placements.bridge]
position = [0.0, 0.0, 24.0]
rotation_vector = [0.012, 0.05, 0.0]
[pair]
a = "bridge"
b = "table"
"""
WINDOW = {"width": 1280, "height": 760}
OPTIONS = [
    "--no-sandbox",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
]


def bridge() -> Solid:
    """Of two feet, along y as thick as `THICK` says."""
    corners = np.array([(x, y, z) for y in (-0.5 * THICK, 0.5 * THICK) for x, z in OUTLINE])
    ends = [(k, (k + 1) % 8) for k in range(8)]
    ends += [(8 + a, 8 + b) for a, b in ends[:8]] + [(k, 8 + k) for k in range(8)]
    caps = [tuple((8 * k + i, 1) for i in range(8)) for k in (0, 1)]
    faces = [
        Face((Plane.through((0, y, 0), (1, 0, 0), (0, 0, 1)),), cap)
        for y, cap in zip((-0.5 * THICK, 0.5 * THICK), caps, strict=True)
    ]
    for k, (a, b) in enumerate(ends[:8]):
        plane = Plane.through(corners[a], corners[b] - corners[a], (0, 1, 0))
        faces.append(Face((plane,), ((k, 1), (16 + b, 1), (8 + k, -1), (16 + a, -1))))
    edges = [Edge(Line(corners[a], corners[b]), a, b) for a, b in ends]
    return Solid.from_brep(corners, edges, faces, name="bridge")


def target(name: str) -> Path:
    """The file that is named on the command line, else one of that name here."""
    return Path(sys.argv[1]) if len(sys.argv) > 1 else HERE / name


def take(page: Any, file: Path, window: dict[str, int], tab_name: str, camera: Any) -> None:
    """Take a picture of a page with a tab of its panel open; `camera` is where it stands, and what
    it looks at."""
    chromium = shutil.which("chromium") or shutil.which("chromium-browser")
    with sync_playwright() as running:
        browser = running.chromium.launch(executable_path=chromium, args=OPTIONS)
        tab = browser.new_page(viewport=window)
        tab.goto(page.address)
        tab.get_by_role("tab", name=tab_name).click(timeout=60_000)
        (client,) = page.server.get_clients().values()
        client.camera.position, client.camera.look_at = camera
        tab.wait_for_timeout(15_000)  # drawn without a graphics card
        tab.evaluate(
            "document.querySelectorAll('[role=alert]').forEach(e => e.style.display = 'none')"
        )
        tab.screenshot(path=file)
        browser.close()


def main() -> None:
    with tempfile.TemporaryDirectory() as folder:
        scene = Path(folder) / "scene.toml"
        save_boundary(scene.with_name("bridge.json"), bridge().boundary)
        scene.write_text(SCENE, "utf-8")
        page = so.view(scene, minima=8.0, patch=1.0, open=False)
    with page:
        page.stage.hand("nothing")
        camera = (54.0, -92.0, 52.0), (17.0, 0.0, 7.0)
        take(page, target("live-solids.png"), WINDOW, "Minima", camera)


if __name__ == "__main__":
    main()
