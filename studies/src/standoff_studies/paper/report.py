"""The report: one HTML file that contains everything and loads nothing."""

from __future__ import annotations

import base64
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import groupby

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup, escape

from standoff import __version__
from standoff_studies.paper.figure import Statement
from standoff_studies.paper.making import Made
from standoff_studies.paper.promises import PROMISES
from standoff_studies.paper.typesetting import pieces, stop
from standoff_studies.paper.verdicts import Verdict, counted
from standoff_studies.paper.writers import ANIMATION, PICTURES

TEMPLATE = "report.html.jinja"

MEDIA = {".png": "image/png", ".svg": "image/svg+xml", ".webp": "image/webp"}


@dataclass(frozen=True)
class Section:
    """A figure as the template shows it.

    Attributes
    ----------
    made : Made
    anchor, name : str
        Its place in the page, and its name: "Fig. 7", or its title.
    picture, animation : str
        As data URIs; empty if there is none.
    """

    made: Made
    anchor: str
    name: str
    picture: str
    animation: str

    @property
    def stated(self) -> list[Statement]:
        """What the paper states."""
        return [s for s in self.made.statements if Verdict.of(s) is not Verdict.OWN]

    @property
    def own(self) -> list[Statement]:
        """What was measured in addition."""
        return [s for s in self.made.statements if Verdict.of(s) is Verdict.OWN]

    @property
    def counts(self) -> dict[Verdict, int]:
        """Its statements by verdict."""
        return counted(self.made.statements)


def report_html(made: Sequence[Made], of: int) -> str:
    """Return the report of some figures.

    Parameters
    ----------
    made : sequence of Made
        In order; the files that they name are read.
    of : int
        Total number of figures.
    """
    sections = [_section(one) for one in made]
    chapters = [(name, list(group)) for name, group in groupby(sections, key=_chapter)]
    environment = Environment(
        loader=PackageLoader("standoff_studies.paper", ""),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["typeset"] = typeset
    statements = [statement for one in made for statement in one.statements]
    environment.globals["zip"] = zip
    return environment.get_template(TEMPLATE).render(
        version=__version__,
        chapters=chapters,
        sections=sections,
        of=of,
        counts=counted(statements),
        Verdict=Verdict,
        stop=stop,
        promises=PROMISES,
        anchors={section.anchor for section in sections},
    )


def typeset(text: str) -> Markup:
    """Return a text as HTML, with indices and powers lowered and raised, and the rest escaped."""
    parts = [
        Markup(f"<{level}>{{}}</{level}>").format(part) if level else escape(part)
        for part, level in pieces(text)
    ]
    return Markup("").join(parts)


def _chapter(section: Section) -> str:
    return section.made.entry.chapter


def _section(made: Made) -> Section:
    key = made.entry.key
    name = f"Fig. {key}" if key.isdecimal() else ""
    pictures = [_data_uri(made, ending) for ending in PICTURES]
    return Section(
        made,
        f"figure-{key}",
        name,
        min(filter(None, pictures), key=len, default=""),
        _data_uri(made, ANIMATION),
    )


def _data_uri(made: Made, ending: str) -> str:
    """A figure's file as part of the page; empty if it has none with this extension."""
    path = made.file(ending)
    if path is None:
        return ""
    return f"data:{MEDIA[ending]};base64,{base64.b64encode(path.read_bytes()).decode('ascii')}"
