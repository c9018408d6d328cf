"""Formulas as MathML, written at build time.

A page of MathML needs no script, no font file and no network in the reader's browser, and no LaTeX
where it is built: docutils, on which Sphinx stands, has the translator. A formula that it cannot
read, or would misread, is a warning, so it fails the build.
"""

from __future__ import annotations

import re
from typing import Any

from docutils import nodes
from docutils.utils.math import MathError
from docutils.utils.math.latex2mathml import tex2mathml
from sphinx.application import Sphinx
from sphinx.util import logging

logger = logging.getLogger(__name__)

# What the translator takes without a complaint and sets wrongly, and what to write instead.
MISREAD = (
    (re.compile(r"\\[td]?frac\s*\d\s*\d"), r"write \frac{1}{2} with braces"),
    (
        re.compile(r"\\d?dot(\s*[a-zA-Z]|\s*\{[a-zA-Z]\}|\s+\\[a-zA-Z]+)\s*_"),
        "an accent with an index puts the index below: write dx_f/dt",
    ),
)


def _mathml(node: nodes.Element, as_block: bool) -> str:
    source = node.astext()
    for form, advice in MISREAD:
        if form.search(source):
            logger.warning("formula %r: %s", source, advice, location=node)
    try:
        return str(tex2mathml(source, as_block=as_block))
    except MathError as error:
        logger.warning("formula %r: %s", source, error, location=node)
        return f"<code>{nodes.unescape(source)}</code>"


def inline_formula(writer: Any, node: nodes.math) -> None:
    """Write a formula within a line."""
    writer.body.append(_mathml(node, as_block=False))
    raise nodes.SkipNode


def displayed_formula(writer: Any, node: nodes.math_block) -> None:
    """Write a formula on lines of its own; a long one scrolls within them."""
    writer.body.append(f'<div class="formula">{_mathml(node, as_block=True)}</div>\n')
    raise nodes.SkipNode


def setup(app: Sphinx) -> dict[str, bool]:
    """Register the renderer under the name ``mathml``."""
    app.add_html_math_renderer("mathml", (inline_formula, None), (displayed_formula, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}
