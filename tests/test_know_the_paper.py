"""The page for readers of the paper: each option, function and figure that it names is there."""

import dataclasses
import re
from pathlib import Path

import standoff as so
from standoff_studies.paper import normals_system
from standoff_studies.paper.catalogue import chosen

ROOT = Path(__file__).parents[1]
PAGE = (ROOT / "docs" / "know-the-paper.md").read_text("utf-8")
KERNELS = ROOT / "src" / "standoff" / "kernels"


def test_its_options_are_those_of_the_law() -> None:
    fields = {field.name for field in dataclasses.fields(so.PaperLaw)}
    named = set()
    for options in re.findall(r"PaperLaw\(([a-z=, ]+=)\)", PAGE):
        named |= {name.strip(" =") for name in options.split(",")}
    assert named
    assert named <= fields
    assert {"realisation", "solve", "feedforward", "gain", "switching", "reset"} <= named
    printed, own = so.PaperLaw.as_printed(gain=100.0), so.PaperLaw().resolved(1e-3)
    rows = re.findall(r"^\| `(\w+)` \| `([^`]+)`[^|]*\| `([^`]+)`", PAGE, re.MULTILINE)
    assert {name for name, _, _ in rows} == {
        "realisation",
        "switching",
        "saturation",
        "reset",
        "solve",
        "restarts",
    }
    for name, as_printed, default in rows:
        assert str(getattr(printed, name)) == as_printed.strip('"')
        if name != "saturation":
            assert str(getattr(own, name)) == default.strip('"')


def test_its_functions_are_there() -> None:
    for name in re.findall(r"`so\.([\w.]+)`", PAGE):
        value = so
        for part in name.split("."):
            value = getattr(value, part)
    for name in ("GainMatrix", "PI", "FiniteTime", "MotionGain"):
        assert f"`{name}`" in PAGE
        assert hasattr(so.feedback, name)
    system = so.tracking.PairSystem.__annotations__
    assert {"Psi", "M", "b"} <= set(system)


def test_its_kernels_cite_the_equations() -> None:
    cited = {"projection_errors": "(1)-(4)", "hessian": "(9)", "feedforward": "(10)"}
    source = (KERNELS / "pair" / "system.py").read_text("utf-8")
    for kernel, equation in cited.items():
        assert f"kernel `{kernel}`" in PAGE
        body = source[source.index(f"def {kernel}(") :]
        assert equation in body[: body.index("\n@")]
    assert "`normals_residual`" in PAGE
    assert callable(normals_system.normals_residual)


def test_its_figures_can_be_made_and_all_are_there() -> None:
    keys = [key for key in re.findall(r"`standoff paper ([\d-]+)`", PAGE) if key != "7"]
    entries = [entry.key for key in keys for entry in chosen([key])]
    assert sorted(map(int, entries)) == list(range(1, 21))


def test_its_links_lead_to_pages() -> None:
    links = re.findall(r"\]\(([\w/-]+\.md)\)", PAGE)
    assert len(links) > 20
    assert not [link for link in links if not (ROOT / "docs" / link).is_file()]
