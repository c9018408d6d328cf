"""The pictures of designs: ``python docs/images/make_design_pictures.py``."""

from __future__ import annotations

import runpy
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import standoff as so

HERE = Path(__file__).parent
EXAMPLES = HERE.parents[1] / "examples"
PLANAR = runpy.run_path(str(HERE / "make_planar_solids_picture.py"))


def cam() -> None:
    """The cam with its roller, and the lash of many cams over the turn."""
    program = runpy.run_path(str(EXAMPLES / "design" / "cam_tolerances.py"))
    found = program["analysed"](100_000, angles=180, remade=40)
    figure, (left, middle, right) = plt.subplots(
        1, 3, figsize=(11.0, 3.8), layout="constrained", width_ratios=(1.0, 1.6, 1.2)
    )
    turn = np.linspace(0.0, 2.0 * np.pi, 400)
    ways = np.array([np.cos(turn), np.sin(turn)])
    given = program["CAM"]
    top = given["reach"] * np.array([-np.sin(given["phase"]), np.cos(given["phase"])])
    # the outline of two discs and their tangents is where their support function is reached
    reach = np.where(top @ ways + given["nose"] > given["base"], given["nose"], given["base"])
    points = ways * reach + np.where(reach == given["nose"], 1.0, 0.0) * top[:, None]
    left.fill(*points, facecolor="tab:blue", alpha=0.15)
    left.plot(*points, color="tab:blue")
    _, (placed, *_) = program["first_order"](180)[0]
    wheel = program["ROLLER"]["radius"]
    left.fill(wheel * ways[0], placed[1, 3] + wheel * ways[1], facecolor="tab:green", alpha=0.15)
    left.plot(wheel * ways[0], placed[1, 3] + wheel * ways[1], color="tab:green")
    left.plot(0.0, 0.0, "+", color="black")
    left.set_aspect("equal")
    left.axis("off")
    left.set_title("a cam and its roller")

    angles = np.degrees(np.linspace(0.0, 2.0 * np.pi, 180, endpoint=False))
    three = 3.0 * found["spread"]
    nominal = program["LASH"]
    middle.fill_between(angles, nominal - three, nominal + three, color="tab:blue", alpha=0.2)
    middle.plot(angles, found["exact"].T, color="gray", linewidth=0.4)
    middle.axhline(nominal, color="tab:blue")
    middle.axhline(program["ALLOWED"], color="tab:red", linestyle="--")
    middle.set_xlabel("angle of the shaft [°]")
    middle.set_ylabel("lash [mm]")
    middle.set_title("three standard deviations; gray: 40 parts made")

    right.hist(found["least"], bins=120, color="tab:blue", alpha=0.6)
    right.axvline(program["ALLOWED"], color="tab:red", linestyle="--", label="least allowed")
    right.set_xlabel("least lash over the turn [mm]")
    right.set_yticks([])
    right.legend(frameon=False, loc="upper right")
    right.set_title("100 000 parts, to first order")
    figure.savefig(HERE / "design-cam.png", dpi=120)


def gears() -> None:
    """Both gaps of a pair of gears with much play, B turned to either side."""
    program = runpy.run_path(str(EXAMPLES / "design" / "gear_backlash.py"))
    pair = program["Pair"].of((20, 31), 0.012, 25.5)
    figure, axes = plt.subplots(1, 2, figsize=(9.0, 4.2), layout="constrained")
    for panel, turned, name in zip(axes, (0.012, -0.012), ("one", "the other"), strict=True):
        a, b = program["GEARS"]["in_mesh"](0.1, *pair.teeth, pair.centres)
        b = so.Pose(b.rotation @ program["GEARS"]["turn"](turned), b.translation)
        answer = so.distance(pair.a.body, pair.b.body, a, b)
        PLANAR["outline"](panel, pair.a.body, a, "tab:blue")
        PLANAR["outline"](panel, pair.b.body, b, "tab:green")
        PLANAR["pairs"](panel, answer)
        panel.set_xlim(7.8, 12.2)
        panel.set_ylim(-2.2, 2.2)
        panel.set_aspect("equal")
        panel.axis("off")
        panel.set_title(f"B turned to {name} side: gap {answer.distance:.3f} mm")
    figure.savefig(HERE / "design-gears.png", dpi=120)


if __name__ == "__main__":
    cam()
    gears()
