"""The options of ``standoff paper``: data that tyro fills in and the command reads."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from tyro.conf import Positional, arg


@dataclass(frozen=True)
class PaperOptions:
    """The options of the command: one for each field, with the field's docstring as its help."""

    keys: Annotated[
        Positional[tuple[str, ...]], arg(metavar="[KEY ...|all]", help_behavior_hint="")
    ] = ("all",)
    """Figures by number (7, 8-11) or word (voronoi); --list shows them. If none is given, all."""
    output: Annotated[Path, arg(aliases=["-o"], metavar="DIR", help_behavior_hint="")] = Path(
        "standoff-paper"
    )
    """Folder of the pictures, tables, animations and report.html; made if it does not exist. If
    not given, standoff-paper."""
    list: Annotated[bool, arg(help_behavior_hint="")] = False
    """Only list the figures."""
    json: Annotated[bool, arg(help_behavior_hint="")] = False
    """Print what was made and every statement as JSON."""
    no_animations: Annotated[bool, arg(help_behavior_hint="")] = False
    """Leave the moving pictures out, which take most of the time."""
    jobs: Annotated[int | None, arg(metavar="N", help_behavior_hint="")] = None
    """Most processes at once; 2 if not given."""

    def announcement(self) -> str:
        """What is about to be done."""
        if self.list:
            return ""
        from standoff.cli.announcement import shown

        which = "all figures" if "all" in self.keys else f"figures {shown(', '.join(self.keys))}"
        moving = "" if self.no_animations else " and animations"
        return f"making {which}{moving} of the paper into {shown(self.output)}"
