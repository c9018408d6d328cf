"""Figures of the paper on a page, made at build time by the code that ``standoff paper`` runs.

``paper-figure`` shows a figure with its caption, ``paper-statements`` sets what the paper states
beside what was measured, ``paper-tables`` prints its tables. Each takes the figure's key. A figure
is made once a build, by the process that reads its page: the figures of a chapter stand on one page
and share its run. A key that no figure has, a figure that fails, a statement that does not name its
law, and a row of promises.md that is no longer true is a warning, so it fails the build.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from functools import cache
from pathlib import Path
from typing import Any

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.environment import BuildEnvironment
from sphinx.util import logging
from sphinx.util.docutils import SphinxDirective

import standoff_studies.paper
from standoff_studies.paper.catalogue import UnknownFigure, chosen, make
from standoff_studies.paper.figure import Artwork, Entry, Statement, missing_words, shown_tables
from standoff_studies.paper.promises import faults
from standoff_studies.paper.typesetting import pieces, stop
from standoff_studies.paper.verdicts import Verdict
from standoff_studies.paper.writers import picture_bytes, stem

logger = logging.getLogger(__name__)

HANDS = 4
"""Parts in which the pages are dealt out: about as many as Sphinx makes for two processes."""

HEADINGS = ("source", "the paper states", "measured", "verdict")

# Figures are made of these; a page is read again when one of them changes.
SOURCES = sorted(Path(standoff_studies.paper.__file__).parent.glob("**/*.py"))


@cache
def artwork_of(entry: Entry) -> Artwork:
    """A figure, made once a build; its statements say what they have to, and what rows quote."""
    artwork = make(entry)
    for statement in artwork.statements:
        missing = missing_words(statement)
        if missing:
            raise ValueError(f'"{statement.stated}" does not say {missing}.')
    for row, fault in faults(entry.key, artwork.statements):
        raise ValueError(f"The row of promises.md on “{row.says}” is no longer true: {fault}.")
    return artwork


@cache
def picture_of(entry: Entry) -> tuple[str, bytes]:
    """The smaller of a figure's pictures: ending and content."""
    pictures = picture_bytes(artwork_of(entry))
    return min(pictures.items(), key=lambda item: len(item[1]))


class picture(nodes.General, nodes.Element):
    """A picture that lies in the build, not beside the page."""


class PaperDirective(SphinxDirective, ABC):
    """What both directives share: the figure that the argument names."""

    required_arguments = 1

    def run(self) -> list[nodes.Node]:
        """Make the figure; what goes wrong is a warning of the page."""
        for source in SOURCES:
            self.env.note_dependency(str(source))
        try:
            (entry,) = chosen(self.arguments)
            return self.content_of(entry)
        except UnknownFigure as error:
            logger.warning("%s", error, location=self.get_location())
        except Exception as error:
            message = "figure %s failed: %s: %s"
            logger.warning(
                message, *self.arguments, type(error).__name__, error, location=self.get_location()
            )
        return []

    @abstractmethod
    def content_of(self, entry: Entry) -> list[nodes.Node]:
        """The nodes that stand on the page."""


class PaperFigure(PaperDirective):
    """``paper-figure``: picture and caption."""

    def content_of(self, entry: Entry) -> list[nodes.Node]:
        """A figure with its alternative text."""
        artwork = artwork_of(entry)
        ending, content = picture_of(entry)
        folder = Path(self.env.app.outdir) / "_images"
        folder.mkdir(parents=True, exist_ok=True)
        name = f"paper-{stem(entry)}{ending}"
        (folder / name).write_bytes(content)
        label = f"Fig. {entry.key}. " if entry.key.isdecimal() else ""
        caption = nodes.caption("", "", *words(f"{label}{artwork.caption}"))
        shown = picture(name=name, alt=artwork.text)
        return [nodes.figure("", shown, caption, classes=["paper-figure"])]


class PaperStatements(PaperDirective):
    """``paper-statements``: a table of what the paper states and what was measured."""

    def content_of(self, entry: Entry) -> list[nodes.Node]:
        """A table, and a list of our own measurements; nothing where the figure has neither."""
        statements = artwork_of(entry).statements
        own = [s for s in statements if Verdict.of(s) is Verdict.OWN]
        stated = [s for s in statements if s not in own]
        return [*([table_of(stated)] if stated else []), *(list_of(own) if own else [])]


class PaperTables(PaperDirective):
    """``paper-tables``: the tables of a figure that are printed in full."""

    def content_of(self, entry: Entry) -> list[nodes.Node]:
        """One table after the other, each with its name."""
        tables = []
        for name, columns in shown_tables(artwork_of(entry)).items():
            group = nodes.tgroup("", cols=len(columns))
            group += [nodes.colspec(colwidth=1) for _ in columns]
            head, body = nodes.thead(), nodes.tbody()
            head += row_of(tuple(columns))
            for row in zip(*columns.values(), strict=True):
                body += row_of(row)
            group += [head, body]
            title = nodes.title("", name.replace("_", " ").capitalize())
            tables.append(nodes.table("", title, group, classes=["paper-table"]))
        return tables


def list_of(statements: list[Statement]) -> list[nodes.Node]:
    """Measurements on which the paper says nothing."""
    items = nodes.bullet_list()
    for s in statements:
        text = f"{s.measured}{stop(s.why)} {s.why}" if s.why else s.measured
        items += nodes.list_item("", nodes.paragraph("", "", *words(text)))
    return [nodes.paragraph("", "Measured beside it:"), items]


def table_of(statements: list[Statement]) -> nodes.table:
    """The statements as a table."""
    group = nodes.tgroup("", cols=len(HEADINGS))
    group += [nodes.colspec(colwidth=width) for width in (12, 33, 30, 25)]
    head, body = nodes.thead(), nodes.tbody()
    head += row_of(HEADINGS)
    for s in statements:
        verdict = Verdict.of(s)
        said = f"{verdict.sign} {verdict.words}"
        why = f"{said}{stop(s.why)} {s.why}" if s.why else said
        measured = f"{s.measured}. By: {s.by}" if s.by else s.measured
        body += row_of((s.source, s.stated, measured, why))
    group += [head, body]
    return nodes.table("", group, classes=["paper-statements"])


def row_of(texts: tuple[str, ...]) -> nodes.row:
    """One row of a table."""
    cells = (nodes.paragraph("", "", *words(text)) for text in texts)
    return nodes.row("", *(nodes.entry("", cell) for cell in cells))


def words(text: str) -> list[nodes.Node]:
    """A text whose indices and powers, as in f_u and 1e-9, are set lower and higher."""
    raised = {"sub": nodes.subscript, "sup": nodes.superscript}
    return [raised[level]("", part) if level else nodes.Text(part) for part, level in pieces(text)]


def write_picture(writer: Any, node: picture) -> None:
    """Write the picture of a figure; large ones shrink to the page."""
    path = f"{writer.builder.imgpath}/{node['name']}"
    writer.body.append(
        f'<img src="{path}" alt="{writer.attval(node["alt"])}" style="width: 100%" loading="lazy">'
    )
    raise nodes.SkipNode


def write_text(writer: Any, node: picture) -> None:
    """Say what the picture shows, where there are none."""
    writer.add_text(node["alt"])
    raise nodes.SkipNode


def spread(_app: Sphinx, _env: BuildEnvironment, docnames: list[str]) -> None:
    """Deal the paper's pages out, which take far longer than all others: neighbours in the list are
    read by one process."""
    ordered = sorted(docnames, key=lambda name: (not name.startswith("paper/"), name))
    docnames[:] = [name for first in range(HANDS) for name in ordered[first::HANDS]]


def setup(app: Sphinx) -> dict[str, bool]:
    """Register the directives."""
    app.connect("env-before-read-docs", spread)
    app.add_node(picture, html=(write_picture, None), text=(write_text, None))
    app.add_directive("paper-figure", PaperFigure)
    app.add_directive("paper-statements", PaperStatements)
    app.add_directive("paper-tables", PaperTables)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
