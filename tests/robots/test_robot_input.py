"""What a robot refuses, and what it says of it; nothing is half loaded."""

from __future__ import annotations

import importlib
import sys
from pathlib import Path

import numpy as np
import pytest
from robot_models import MJCF, URDF, exact_robot

import standoff as so

mujoco = pytest.importorskip("mujoco")
pin = pytest.importorskip("pinocchio")

TETRAHEDRON = "0 0 0  .1 0 0  0 .1 0  0 0 .1  .02 .02 .02"


def mjcf(body: str, assets: str = "") -> object:
    """A MuJoCo model of a ball and one body on a hinge."""
    return mujoco.MjModel.from_xml_string(f"""
<mujoco model="small"><asset>{assets}</asset><worldbody>
  <geom name="ball" type="sphere" size=".1" pos="0 0 1"/>
  <body name="arm"><joint name="turn" axis="0 1 0"/>{body}</body>
</worldbody></mujoco>""")


def written(tmp_path: Path, text: str, name: str = "robot.urdf") -> Path:
    path = tmp_path / name
    path.write_text(text)
    return path


def link(collision: str, joint: str = "revolute") -> str:
    """A robot of one moving link with a collision geometry."""
    return f"""
<robot name="one"><link name="base">
  <collision><geometry><sphere radius=".1"/></geometry></collision></link>
<link name="mid"/><link name="arm">{collision}</link>
<joint name="first" type="revolute"><parent link="base"/><child link="mid"/>
  <origin xyz="0 0 1"/><axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="1" velocity="1"/>
</joint>
<joint name="turn" type="{joint}"><parent link="mid"/><child link="arm"/><origin xyz="0 0 1"/>
  <axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint></robot>"""


MESH = '<collision><geometry><mesh filename="package://none/{}.stl"/></geometry></collision>'


def test_a_mesh_is_refused_by_name_unless_asked_for() -> None:
    mesh = f'<mesh name="horn" vertex="{TETRAHEDRON}"/>'
    model = mjcf('<geom name="horn" type="mesh" mesh="horn"/>', mesh)
    with pytest.raises(so.StandoffError, match=r"'horn' on link 'arm' is a mesh: give meshes="):
        so.Robot.from_mujoco(model)
    hull = so.Robot.from_mujoco(model, meshes="hull")
    row = hull.report().geoms[1]
    assert (row.name, row.became) == ("horn", "hull")
    assert row.gap <= 1e-9
    assert so.Robot.from_mujoco(model, meshes={"horn": "hull"}).pairs == hull.pairs
    left = so.Robot.from_mujoco(model, skip=["arm"], obstacles={"box": so.shapes.box(1, 1, 1)})
    assert left.report().geoms[1].became == "skipped"
    assert left.pairs == []


def test_a_body_for_a_mesh_stands_where_its_file_says() -> None:
    """MuJoCo puts meshes about their centre; a body that is given is in the file's frame."""
    corners = np.array(TETRAHEDRON.split(), dtype=float).reshape(-1, 3)
    mesh = f'<mesh name="horn" vertex="{TETRAHEDRON}"/>'
    model = mjcf('<geom name="horn" type="mesh" mesh="horn" pos=".1 0 .3"/>', mesh)
    given = so.Robot.from_mujoco(model, meshes={"horn": so.Body.from_points(corners)})
    hull = so.Robot.from_mujoco(model, meshes="hull")
    q = [0.4]
    assert abs(given.clearance(q).distance - hull.clearance(q).distance) <= 1e-7  # of float32
    assert given.report().geoms[1].became == "given"


def test_the_gap_of_a_hull_is_the_greatest_distance_from_its_mesh() -> None:
    """A cross of two bars: its hull is farthest from it in the notches."""
    from standoff.robots.shapes import hull_gap

    bars = [(3.0, 1.0, 1.0), (1.0, 3.0, 1.0)]
    corners, triangles = [], []
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    for size in bars:
        first = len(corners)
        signs = [(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
        corners += [0.5 * np.array(size) * s for s in signs]
        triangles += [(first + f[0], first + f[k], first + f[k + 1]) for f in faces for k in (1, 2)]
    gap = hull_gap(np.array(corners), np.array(triangles))
    exact = 1.0  # of (0.5, 1.5) - (1.5, 0.5), in the middle at (1, 1): from the bars 0.5
    assert 0.45 * exact <= gap <= 0.5 * exact + 1e-12


@pytest.mark.parametrize(
    ("kind", "assets", "geom"),
    [
        (
            "a height field",
            '<hfield name="hills" nrow="2" ncol="2" size="1 1 1 .1" elevation="0 1 1 0"/>',
            '<geom name="hills" type="hfield" hfield="hills"/>',
        ),
    ],
)
def test_kinds_without_a_body_are_named(kind: str, assets: str, geom: str) -> None:
    model = mujoco.MjModel.from_xml_string(f"""
<mujoco><asset>{assets}</asset><worldbody>{geom}
<body name="arm"><freejoint/><geom name="ball" size=".1"/></body></worldbody></mujoco>""")
    with pytest.raises(so.StandoffError, match=f"'hills' on link 'world' is {kind}.*skip"):
        so.Robot.from_mujoco(model)
    for meshes in ("hull", {"hills": "hull"}):
        with pytest.raises(so.StandoffError, match=kind):
            so.Robot.from_mujoco(model, meshes=meshes)
    assert so.Robot.from_mujoco(model, skip=["hills"]).pairs == []


def test_a_coal_plane_is_refused_by_name() -> None:
    """Its two sides are solid: no body is."""
    import coal

    model, geometry = pin.Model(), pin.GeometryModel()
    joint = model.addJoint(0, pin.JointModelRX(), pin.SE3.Identity(), "turn")
    for name, shape in (("wall", coal.Plane(np.array([0.0, 0, 1]), 0.0)), ("b", coal.Sphere(0.1))):
        carrier = 0 if name == "wall" else joint
        geometry.addGeometryObject(pin.GeometryObject(name, carrier, pin.SE3.Identity(), shape))
    with pytest.raises(so.StandoffError, match=r"no collision pairs.*addAllCollisionPairs"):
        so.Robot.from_pinocchio(model, geometry)
    geometry.addAllCollisionPairs()
    with pytest.raises(so.StandoffError, match="'wall' on link 'universe'"):
        so.Robot.from_pinocchio(model, geometry)


def test_coal_s_shapes_are_those_that_coal_has() -> None:
    """Each beside a ball, swept radii and all, by Coal's own distance."""
    import coal

    shapes = [
        *(coal.Sphere(0.1), coal.Box(0.2, 0.3, 0.4), coal.Capsule(0.1, 0.3)),
        *(coal.Cylinder(0.1, 0.3), coal.Cone(0.2, 0.3), coal.Ellipsoid(0.1, 0.2, 0.3)),
        coal.Halfspace(np.array([0.0, 0.6, 0.8]), 0.1),
    ]
    for shape in shapes:
        for swept in (0.0, 0.05):
            shape.setSweptSphereRadius(swept)
            model, geometry = pin.Model(), pin.GeometryModel()
            joint = model.addJoint(0, pin.JointModelTranslation(), pin.SE3.Identity(), "move")
            ball = coal.Sphere(0.1)
            for k, (name, x) in enumerate((("it", shape), ("ball", ball))):
                geometry.addGeometryObject(
                    pin.GeometryObject(name, joint * k, pin.SE3.Identity(), x)
                )
            geometry.addAllCollisionPairs()
            q = np.array([0.5, 0.7, 0.9])
            answer = so.Robot.from_pinocchio(model, geometry).clearance(q)
            theirs = coal.distance(
                shape,
                coal.Transform3s.Identity(),
                ball,
                coal.Transform3s(np.eye(3), q),
                coal.DistanceRequest(),
                coal.DistanceResult(),
            )
            assert abs(theirs - answer.distance) <= 2e-6, shape


def test_files_of_meshes_that_are_not_there_are_named(tmp_path: Path) -> None:
    path = written(tmp_path, link(MESH.format("a") + MESH.format("b")))
    with pytest.raises(so.StandoffError, match="'arm_0' on link 'arm' is a mesh"):
        so.Robot.from_urdf(path)
    with pytest.raises(so.StandoffError, match=r"2 files of meshes are not there") as error:
        so.Robot.from_urdf(path, meshes="hull")
    assert "package://none/a.stl" in str(error.value)
    assert "package_dirs" in str(error.value)
    with pytest.raises(so.StandoffError, match=r"1 files of meshes"):
        so.Robot.from_urdf(path, meshes="hull", skip=["arm_1"])
    ball = so.shapes.sphere(0.1)
    robot = so.Robot.from_urdf(path, meshes={"arm_0": ball}, skip=["arm_1"])
    assert [(g.kind, g.became) for g in robot.report().geoms[1:]] == [
        ("mesh", "given"),
        ("mesh", "skipped"),
    ]
    assert abs(robot.clearance([0.0, 0.0]).distance - 1.8) <= 1e-12


def test_a_robot_without_collision_geometry(tmp_path: Path) -> None:
    text = """<robot name="ghost"><link name="base"><inertial><mass value="1"/>
<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link></robot>"""
    with pytest.raises(so.StandoffError, match="no collision geometry"):
        so.Robot.from_urdf(written(tmp_path, text))
    ghost = mjcf('<geom name="seen" size=".1" contype="0" conaffinity="0"/>')
    ghost.geom_contype[:] = ghost.geom_conaffinity[:] = 0
    with pytest.raises(so.StandoffError, match=r"no geometry that collides \(2 in all\)"):
        so.Robot.from_mujoco(ghost)


def test_mimic_joints_are_to_be_decided(tmp_path: Path) -> None:
    path = written(tmp_path, URDF.format(grip="revolute"))
    with pytest.raises(so.StandoffError, match=r"1 joints? that mimic.*grip.*mimic=True.*False"):
        so.Robot.from_urdf(path)


def test_an_unknown_joint_is_named(tmp_path: Path) -> None:
    with pytest.raises(
        so.StandoffError, match=r"joint 'turn': it is of the type 'wobbly'; URDF has"
    ):
        so.Robot.from_urdf(written(tmp_path, link("", "wobbly")))
    model, geometry = pin.Model(), pin.GeometryModel()
    model.addJoint(0, pin.JointModelHelicalUnaligned(np.array([0, 0, 1.0]), 0.1),
                   pin.SE3.Identity(), "screw")  # fmt: skip
    with pytest.raises(so.StandoffError, match=r"'screw'.*JointModelHelicalUnaligned"):
        so.Robot.from_pinocchio(model, geometry)


def test_an_srdf_of_another_robot(tmp_path: Path) -> None:
    path = written(tmp_path, URDF.format(grip="revolute"))
    other = '<robot name="x"><disable_collisions link1="nose" link2="ear"/></robot>'
    with pytest.raises(so.StandoffError, match=r"another robot.*ear, nose"):
        so.Robot.from_urdf(path, written(tmp_path, other, "x.srdf"), mimic=True)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "is not XML"),
        ("<mujoco/>", "begins with <mujoco>"),
        ("<robot name='x'><joint/></robot>", "<joint> 0: it has no name"),
    ],
)
def test_files_that_are_no_urdf(tmp_path: Path, text: str, said: str) -> None:
    with pytest.raises(so.StandoffError, match=said):
        so.Robot.from_urdf(written(tmp_path, text))


def test_files_that_are_not_there(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError, match="path: there is no file"):
        so.Robot.from_urdf(tmp_path / "none.urdf")
    with pytest.raises(FileNotFoundError, match="no model file"):
        so.Robot.from_mujoco(str(tmp_path / "none.xml"))
    with pytest.raises(so.StandoffError, match="MuJoCo does not read"):
        so.Robot.from_mujoco(written(tmp_path, "<mujoco><nonsense/></mujoco>", "m.xml"))


@pytest.mark.parametrize("wrong", [3, None, so.shapes.sphere(0.1)])
def test_what_is_no_model(wrong: object) -> None:
    with pytest.raises(so.StandoffError, match=r"give a mujoco\.MjModel"):
        so.Robot.from_mujoco(wrong)
    with pytest.raises(so.StandoffError, match=r"give a pinocchio\.Model"):
        so.Robot.from_pinocchio(wrong, wrong)
    with pytest.raises(so.StandoffError, match=r"give a pinocchio\.GeometryModel"):
        so.Robot.from_pinocchio(pin.Model(), wrong)
    with pytest.raises(TypeError, match="give the path"):
        so.Robot.from_urdf(wrong)


def test_configurations_of_the_wrong_size_or_beyond_limits() -> None:
    robot = exact_robot("panda")
    with pytest.raises(so.StandoffError, match=r"shape \(3,\).*nq = 8.*pinocchio\.neutral"):
        robot.clearance([0.0, 0.0, 0.0])
    with pytest.raises(so.StandoffError, match="NaN"):
        robot.distances([np.nan] * 8)
    with pytest.raises(so.StandoffError, match=r"Q has the shape \(8,\): give \(m, 8\)"):
        robot.clearances(np.zeros(8))
    beyond = np.zeros(8)
    beyond[[1, 3]] = 9.0, 1.0
    assert robot.outside(beyond) == ("panda_joint2", "panda_joint4")
    assert robot.clearance(beyond).certified  # limits are the planner's matter


def test_a_floating_base_needs_a_unit_quaternion(tmp_path: Path) -> None:
    path = written(
        tmp_path, link('<collision><geometry><box size=".1 .1 .1"/></geometry></collision>')
    )
    robot = so.Robot.from_urdf(path, free_base=True)
    assert (robot.nq, robot.nv) == (9, 8)
    q = robot.kinematics.neutral()
    assert robot.clearance(q).certified
    q[3:7] = 0.0
    with pytest.raises(so.StandoffError, match=r"q\[3:7\].*quaternion.*root_joint.*length 0"):
        robot.clearance(q)
    q[3:7] = 0.0, 0.0, 0.6, 0.8001
    assert np.abs(np.linalg.norm(robot.kinematics.check(q)[3:7]) - 1.0) <= 1e-15
    with pytest.raises(so.StandoffError, match=r"Row 1 of Q: .*quaternion"):
        robot.clearances([robot.kinematics.neutral(), np.zeros(9)])


def test_names_that_nobody_has() -> None:
    model = mujoco.MjModel.from_xml_string(MJCF)
    with pytest.raises(so.StandoffError, match=r"skip has 'trunc'.*'trunk'"):
        so.Robot.from_mujoco(model, skip=["trunc"])
    with pytest.raises(so.StandoffError, match="meshes has 'trunc'"):
        so.Robot.from_mujoco(model, meshes={"trunc": "hull"})
    with pytest.raises(so.StandoffError, match="meshes has 'trunk', which is a ellipsoid"):
        so.Robot.from_mujoco(model, meshes={"trunk": "hull"})
    with pytest.raises(TypeError, match="meshes = 3"):
        so.Robot.from_mujoco(model, meshes=3)
    with pytest.raises(TypeError, match="give a list"):
        so.Robot.from_mujoco(model, skip="trunk")
    robot = so.Robot.from_mujoco(model)
    with pytest.raises(so.StandoffError, match="obstacles has 'trunk'"):
        robot.with_obstacles({"trunk": so.shapes.sphere(1.0)})
    with pytest.raises(TypeError, match="The obstacle 'a' is 3"):
        robot.with_obstacles({"a": 3})
    with pytest.raises(so.StandoffError, match="The obstacle 'a': "):
        robot.with_obstacles({"a": (so.shapes.sphere(1.0), np.zeros((4, 4)))})
    with pytest.raises(so.StandoffError, match="within = -1"):
        robot.distances(robot.kinematics.neutral(), within=-1.0)
    other = so.Robot.from_mujoco(model)
    with pytest.raises(so.StandoffError, match="another world"):
        robot.step(other.start(robot.kinematics.neutral()), robot.kinematics.neutral())


def test_a_robot_that_watches_nothing() -> None:
    model = mjcf('<geom name="box" type="box" size=".1 .1 .1" contype="2" conaffinity="2"/>')
    robot = so.Robot.from_mujoco(model)
    assert robot.pairs == []
    assert len(robot.distances([0.0])) == 0
    with pytest.raises(so.StandoffError, match="watches no pair: add obstacles"):
        robot.clearance([0.0])


def test_the_report_is_a_table_of_all_geometries() -> None:
    robot = so.Robot.from_mujoco(mujoco.MjModel.from_xml_string(MJCF))
    report = robot.report()
    lines = str(report).splitlines()
    reasons = [line for line in lines if line.startswith("not watched: ")]
    assert len(lines) == 2 + len(report.geoms) + len(reasons) + len(report.notes)
    assert sum(int(line.split()[2]) for line in reasons) == len(report.left_out)
    assert report.overlapping == ()
    assert "'every joint': 6 joints, 11 geometries" in lines[0]
    assert [row.name for row in report.geoms][:4] == ["floor", "post", "trunk", "seen only"]
    assert report.pairs == tuple(robot.pairs)
    assert any("without limits: turn" in note for note in report.notes)


@pytest.mark.parametrize(
    ("package", "module", "extra"),
    [
        ("mujoco", "mujoco", "mujoco"),
        ("mujoco", "mujoco_contacts", "mujoco"),
        ("mujoco", "mujoco_sensor", "mujoco"),
        ("pinocchio", "urdf", "pinocchio"),
        ("pinocchio", "pinocchio", "pinocchio"),
        ("coal", "pinocchio", "pinocchio"),
        ("casadi", "casadi_functions", "casadi"),
        ("mink", "mink_limit", "mink"),
        ("pink", "pink_barrier", "pink"),
        ("qpsolvers", "safety_filter", "qp"),
    ],
)
def test_a_package_that_is_not_installed_is_told_with_its_extra(
    package: str, module: str, extra: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    used = tuple(f"standoff.robots.{name}" for name in ("mujoco", "pinocchio", "urdf", module))
    for name in [name for name in sys.modules if name.startswith((*used, "standoff.casadi"))]:
        monkeypatch.delitem(sys.modules, name)
    # its own modules too, which another test may have imported
    for name in {package, *(name for name in sys.modules if name.startswith(f"{package}."))}:
        monkeypatch.setitem(sys.modules, name, None)
    with pytest.raises(ModuleNotFoundError, match=rf"pip install 'standoff\[{extra}\]'"):
        importlib.import_module(f"standoff.robots.{module}")
