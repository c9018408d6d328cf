"""Which pairs of a URDF file's geometries are left out, and why."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Collection, Mapping
from pathlib import Path
from typing import Any

from standoff.errors import StandoffError
from standoff.robots.report import RIGID
from standoff.robots.shapes import MOST_NAMED
from standoff.robots.urdf_xml import UrdfTree

Pairs = Mapping[frozenset[str], str]
"""Of two links, or of one: why nothing of them is watched."""


def pairs_left_out(tree: UrdfTree, standing: Collection[str]) -> dict[frozenset[str], str]:
    """Links that are rigid to each other, and those that one joint of the file joins.

    ``standing``: joints that do not move, beside those that are fixed.
    """
    groups = {link: [link] for link in tree.links}
    for joint in tree.joints:
        if joint.kind == "fixed" or joint.name in standing:
            one = groups[joint.parent] + groups[joint.child]
            groups.update(dict.fromkeys(one, one))
    found = {
        frozenset((joint.parent, joint.child)): f"joined by the joint {joint.name!r}"
        for joint in tree.joints
    }
    for link in tree.links:
        found |= {frozenset((link, other)): RIGID for other in groups[link]}
    return found


def disabled(
    srdf: Path, root: Any, links: Collection[str]
) -> tuple[dict[frozenset[str], str], list[str]]:
    """Links whose pairs an SRDF disables, and what should be known of the file.

    Raises StandoffError: an entry that names fewer than two links; a file of another robot, which
    names none of this one's.
    """
    found: dict[frozenset[str], str] = {}
    notes: list[str] = []
    named: set[str] = set()
    for entry in root.iter("disable_collisions"):
        pair = [(entry.get(end) or "").strip() for end in ("link1", "link2")]
        if not all(pair):
            raise StandoffError(
                f"{srdf}: {ET.tostring(entry, encoding='unicode').strip()} names no two links: "
                "give link1 and link2.",
                "srdf",
                srdf,
            )
        named.update(pair)
        reason = entry.get("reason")
        found[frozenset(pair)] = "disabled by the SRDF" + (f" ({reason})" if reason else "")
    strange = sorted(named - set(links))
    if named and len(strange) == len(named):
        raise StandoffError(
            f"{srdf} is of another robot: it names links {', '.join(strange[:MOST_NAMED])}"
            ", of which the URDF has none.",
            "srdf",
            srdf,
        )
    if strange:
        notes.append(f"{srdf.name} names links that the robot does not have: {', '.join(strange)}")
    if not named:
        notes.append(f"{srdf.name} disables no pair")
    unread = sorted({x.tag for x in root if x.tag in UNREAD})
    if unread:
        listed = ", ".join(f"<{tag}>" for tag in unread)
        notes.append(f"{srdf.name} has {listed}, which is not read")
    return found, notes


UNREAD = ("disable_default_collisions", "enable_collisions", "link_sphere_approximation")
"""Elements of an SRDF that speak of collisions too."""
