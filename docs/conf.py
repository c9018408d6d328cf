"""Sphinx: MyST pages, NumPy docstrings, formulas as MathML; nothing is fetched at build or reading.

Build with ``make docs``; every warning is an error.
"""

import re
import sys
from pathlib import Path
from typing import Any

from sphinx.application import Sphinx

import standoff

sys.path.insert(0, str(Path(__file__).parent / "_extensions"))

project = "Standoff"
author = "The Standoff authors"
version = release = standoff.__version__

extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon"]
extensions += ["mathml", "paper", "build_progress"]
# the tables of a report are included by its page
exclude_patterns = ["_extensions", "accuracy-report/accuracy.md"]

myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 3
html_math_renderer = "mathml"

# Docstrings say types with shapes and units; signatures name them short, one a line where long.
autodoc_typehints = "signature"
autodoc_typehints_format = "short"
autodoc_preserve_defaults = True
autodoc_type_aliases = {
    "PoseLike": "standoff.motion.PoseLike",
    "TwistLike": "standoff.motion.TwistLike",
    "Frame": "standoff.motion.Frame",
    "Orientation": "standoff.motion.Orientation",
    **{name: name for name in ("ArrayLike", "Array", "Ints", "Bools")},
}
autodoc_member_order = "bysource"
autodoc_class_signature = "mixed"
napoleon_google_docstring = False
napoleon_use_rtype = False
napoleon_use_ivar = True
python_use_unqualified_type_names = True
python_maximum_signature_line_length = 70
add_module_names = False

# Every reference to a public name must lead somewhere; words of a type ("array_like", "shape"),
# names of other packages and private types in signatures are no references.
nitpicky = True
nitpick_ignore_regex = [("py:.*", r"(?!(standoff|so)(\.(shapes|geometry|motion|scene))?\.\w+$).*")]

# Attributes of several classes share a name (start, end); the type names tell which is meant.
suppress_warnings = ["ref.python"]

html_theme = "furo"
html_title = f"Standoff {version}"
html_static_path = ["_static"]
html_css_files = ["standoff.css"]
html_copy_source = False
html_show_sphinx = False
html_show_copyright = False


def _plain_aliases(_app: Sphinx, _kind: str, _name: str, *rest: Any) -> tuple[Any, Any]:
    """Aliases of `autodoc_type_aliases` within a union or tuple, by their names."""
    signature, result = rest[-2:]
    return tuple(
        re.sub(r"TypeAliasForwardRef\('([^']*)'\)", r"\1", text) if text else text
        for text in (signature, result)
    )


def _one_name_an_attribute(
    _app: Sphinx, _kind: str, _name: str, _what: Any, _options: Any, lines: list[str]
) -> None:
    """An entry "a, b : type" of a section Attributes as two, as napoleon does for Parameters."""
    written: list[str] = []
    inside = False
    block: list[str] = []
    for number, line in enumerate([*lines, ""]):
        ruled = number + 1 < len(lines) and set(lines[number + 1].strip()) == {"-"}
        if ruled or not line[:1].isspace():
            names, colon, rest = block[0].partition(" : ") if block else ("", "", "")
            each = [name.strip() for name in names.split(",")]
            if len(each) > 1 and all(name.isidentifier() for name in each):
                for name in each:
                    written += [name + colon + rest, *block[1:]]
            else:
                written += block
            block = []
        if ruled:
            inside = line.strip() == "Attributes"
        if inside and line.strip():
            block.append(line)
        else:
            written.append(line)
    lines[:] = written


def _plain_bars(
    _app: Sphinx, _kind: str, _name: str, _what: Any, _options: Any, lines: list[str]
) -> None:
    """A magnitude, |v|, is not a substitution of reStructuredText; within ``code`` it is left."""
    for number, line in enumerate(lines):
        parts = re.split(r"(``.*?``)", line)
        lines[number] = "".join(p if p[:2] == "``" else p.replace("|", "\\|") for p in parts)


def setup(app: Sphinx) -> None:
    """Connect what the settings above cannot say."""
    app.connect("autodoc-process-docstring", _one_name_an_attribute, priority=400)
    app.connect("autodoc-process-docstring", _plain_bars, priority=450)
    app.connect("autodoc-process-signature", _plain_aliases)
