"""Draw the four pictures of the README's first screen: docs/images/front-*.png.

Run: python docs/images/make_front_pictures.py [FOLDER]. Needs the extras `cad`, `mujoco` and
`plot`. What is drawn is what the README's own blocks of code make.
"""

import re
import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import to_rgb

import standoff as so
from standoff.bodies.drawing.solids import solid_of
from standoff.solids.drawing.camera import brightness, camera_on, rastered
from standoff.world.shapes import boundary_of

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
BLUE, ORANGE, GREEN, GREY, RED = "#5b8db8", "#d98e4a", "#7fb59b", "#c8c8c8", "#b02020"
WIDE, TALL = 4.4, 3.6  # inches
REST = so.Pose.identity()


class Scene:
    """Bodies seen from an elevation and azimuth, degrees."""

    def __init__(self, view):
        self.view, self.corners, self.normals, self.colours = view, [], [], []

    def add(self, body, pose, colour, white=0.0, away=None):
        """`white`: the share of white in the colour; what is on the side of the plane through the
        origin to which its normal `away` points is cut off."""
        drawn = solid_of(boundary_of(body))
        corners = np.asarray(pose.apply(drawn.points))[drawn.triangles]
        normals = (drawn.normals @ pose.rotation.T)[drawn.triangles].mean(axis=1)
        if away is not None:
            corners, kept = cut(corners, away)
            normals = normals[kept]
        self.corners.append(corners)
        self.normals.append(normals)
        self.colours.append(
            np.tile((1.0 - white) * np.array(to_rgb(colour)) + white, (len(corners), 1))
        )

    def draw(self):
        """The figure, its axes and the camera. A pixel that sees a face from inside shows a cut."""
        corners, normals = np.concatenate(self.corners), np.concatenate(self.normals)
        camera = camera_on(corners.reshape(-1, 3), self.view, 1400)
        triangle = rastered(camera, corners).triangle
        shade = brightness(camera, normals)
        shade[normals @ camera.axes[2] < -0.05] = 1.2
        image = np.ones((*triangle.shape, 3))
        seen = triangle >= 0
        image[seen] = (shade[:, None] * np.concatenate(self.colours))[triangle[seen]]
        figure = plt.figure(figsize=(WIDE, TALL), dpi=130)
        axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
        (left, low), (right, high) = camera.low, camera.high
        axes.imshow(np.clip(image, 0.0, 1.0), extent=(left, right, low, high), origin="lower")
        axes.axis("off")
        return figure, axes, camera


def cut(corners, away):
    """What triangles (n, 3, 3) have below a plane through the origin: triangles, and of which."""
    found, which = [], []
    for k, heights in enumerate(corners @ away):
        ring = []
        for i in range(3):
            j = (i + 1) % 3
            if heights[i] <= 0.0:
                ring.append(corners[k, i])
            if heights[i] * heights[j] < 0.0:
                t = heights[i] / (heights[i] - heights[j])
                ring.append(corners[k, i] + t * (corners[k, j] - corners[k, i]))
        found += [(ring[0], ring[i], ring[i + 1]) for i in range(1, len(ring) - 1)]
        which += [k] * max(len(ring) - 2, 0)
    return np.array(found), which


def gap(axes, camera, answer, colour="black"):
    """The line between the closest points."""
    ends = camera.flat(np.array([answer.point_a, answer.point_b]))
    axes.plot(*ends.T, "-o", color=colour, ms=4, lw=1.6, mfc="white", mew=1.4)
    return ends.mean(axis=0)


def label(axes, text, at, offset, colour="black"):
    axes.annotate(
        text, at, xytext=offset, textcoords="offset points", fontsize=10, color=colour,
        ha="center", arrowprops={"arrowstyle": "-", "color": colour, "lw": 0.8, "shrinkB": 5},
        bbox={"fc": "white", "ec": "none", "alpha": 0.8, "pad": 1.0},
    )  # fmt: skip


def pair(names):
    answer = names["answer"]
    scene = Scene((34.0, -62.0))
    scene.add(names["ring"], REST, BLUE)
    scene.add(names["egg"], names["pose"], ORANGE)
    figure, axes, camera = scene.draw()
    label(axes, f"{answer.distance:.4f}", gap(axes, camera, answer), (40, 55))
    return figure


def clearance():
    """Cut by a plane through the axis in which two of the three gaps are least."""
    parts = {part.name: part for part in so.read_step(ROOT / "examples/cad/bearing.step")}
    parts = {name.split("/")[-1]: part for name, part in parts.items()}
    away, scene = np.array([0.0, -0.8, 0.6]), Scene((36.0, -62.0))
    for name, colour in (("shaft", BLUE), ("housing", GREEN), ("seal", ORANGE)):
        side = None if name == "shaft" else away
        scene.add(parts[name].solid, so.Pose.of(parts[name].pose), colour, away=side)
    figure, axes, camera = scene.draw()
    for names, offset, colour in (
        (("shaft", "seal"), (-50, 35), RED),
        (("shaft", "housing"), (25, 55), "black"),
        (("housing", "seal"), (35, -45), "black"),
    ):
        a, b = (parts[name] for name in names)
        answer = so.distance(a.solid, b.solid, a.pose, b.pose)
        label(axes, f"{answer.distance:.3f} mm", gap(axes, camera, answer, colour), offset, colour)
    return figure


def certify(names):
    robot, scene = names["robot"], Scene((16.0, -88.0))
    left, over, right = (np.array(names[name], float) for name in ("left", "over", "right"))
    proof, hand = robot.certify([left, over, right], clearance=5e-3), []
    for t in np.linspace(0.0, 2.0, 41):
        q = left + t * (over - left) if t < 1.0 else over + (t - 1.0) * (right - over)
        poses = robot.poses(q)
        hand.append(poses[robot.geoms.names.index("palm"), :3, 3])
        for name, joint, body, pose in zip(
            robot.geoms.names, robot.geoms.joints, robot.geoms.bodies, poses, strict=True
        ):
            whole, ghost = t == 1.0, t in (0.0, 2.0) and joint >= 1
            if body.bounded and (whole or ghost):
                colour, white = BLUE if joint >= 0 else GREY, 0.0 if whole else 0.5
                scene.add(body, so.Pose.of(pose), ORANGE if name == "post" else colour, white)
    figure, axes, camera = scene.draw()
    axes.plot(*camera.flat(np.array(hand)).T, color="black", lw=1.2, ls=(0, (4, 3)))
    axes.text(
        0.72, 0.06, f"at least {1e3 * proof.proven:.1f} mm at every instant", fontsize=10,
        ha="center", transform=axes.transAxes, bbox={"fc": "white", "ec": "none", "alpha": 0.8},
    )  # fmt: skip
    return figure


def tracker(names):
    lens, tool = names["tracker"].a, names["tracker"].b
    path, scene = names["path"], Scene((24.0, -20.0))
    scene.add(lens, REST, BLUE)
    found = []
    for t in np.linspace(0.0, 1.0, 6):
        scene.add(tool, path.pose(t), ORANGE, 0.0 if t == 1.0 else 0.5)
        found.append(so.distance(lens, tool, REST, path.pose(t)))
    figure, axes, camera = scene.draw()
    for answer in found:
        gap(axes, camera, answer)
    return figure


def main():
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else HERE
    blocks = re.findall(r"```python\n(.*?)```", (ROOT / "README.md").read_text("utf-8"), re.DOTALL)
    made = [{}, {}, {}]
    for block, names in zip(blocks, made, strict=True):
        exec(compile(block, "README.md", "exec"), names)
    figures = {
        "pair": pair(made[0]),
        "clearance": clearance(),
        "certify": certify(made[1]),
        "tracker": tracker(made[2]),
    }
    for name, figure in figures.items():
        figure.savefig(folder / f"front-{name}.png")


if __name__ == "__main__":
    main()
