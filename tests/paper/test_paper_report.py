"""The report: one file that fetches nothing, with every figure, statement and verdict in it."""

from __future__ import annotations

import base64
import re
import shutil
import subprocess
from html.parser import HTMLParser
from pathlib import Path

import pytest

from families import paper_figures as fakes
from standoff_studies.paper.making import Made, make_and_write
from standoff_studies.paper.report import report_html, typeset
from standoff_studies.paper.typesetting import stop

ENTRIES = (fakes.GOOD, fakes.MOVING, fakes.FAILING, fakes.LAST)
VOID = {"meta", "img", "input", "br"}


class Page(HTMLParser):
    """The report's elements, and whether each is closed where it should be."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.words = ""
        self.feed(text)
        assert self.open == []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))
        if tag not in VOID:
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        if self.open and self.open[-1] != "style":
            self.words += data

    def all(self, tag: str) -> list[dict[str, str | None]]:
        return [attributes for name, attributes in self.tags if name == tag]


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> list[Made]:
    folder = tmp_path_factory.mktemp("figures")
    return [make_and_write(entry, folder, animations=True) for entry in ENTRIES]


@pytest.fixture(scope="module")
def text(made: list[Made]) -> str:
    return report_html(made, of=9)


@pytest.fixture(scope="module")
def page(text: str) -> Page:
    return Page(text)


def test_nothing_is_fetched(text: str, page: Page) -> None:
    assert not {"script", "link", "iframe", "object", "embed", "video"} & {t for t, _ in page.tags}
    for _, attributes in page.tags:
        for name in ("src", "srcset", "href", "data", "poster", "action"):
            assert re.match(r"data:image/|#|$", attributes.get(name) or "")
    assert "url(" not in text
    assert "@import" not in text


def test_pictures_are_embedded_the_smaller_one(made: list[Made], page: Page) -> None:
    sources = [image["src"] or "" for image in page.all("img")]
    smaller = [
        min((one.file(".png"), one.file(".svg")), key=lambda path: path.stat().st_size)
        for one in made
        if not one.error
    ]
    wanted = [path.read_bytes() for path in smaller]
    wanted.insert(2, made[1].file(".webp").read_bytes())
    assert [base64.b64decode(source.split(",")[1]) for source in sources] == wanted
    assert [image["alt"] for image in page.all("img")] == [
        *('It "falls" <steadily>.', "A dot at rest.", "A dot goes up."),
        'It "falls" <steadily>.',
    ]


def test_moving_pictures_wait_to_be_opened(page: Page) -> None:
    (details,) = page.all("details")
    assert "open" not in details


def test_every_statement_stands_beside_its_measurement(page: Page) -> None:
    words = " ".join(page.words.split())
    good = (
        "Fig. 7 10 steps at K = 1000 10 steps ✓ holds "
        "Fig. 7 75 steps at K = 100 70 steps ✗ does not holdAnother start <b> "
        "Section II it is fast it is – no verdict Measured beside it: 1.5 s"
    )
    assert words.count(good) == 2
    assert "✓ 2 hold ✗ 2 do not hold – 2 without a verdict" in words
    assert "2 measurements of our own" in words
    assert words.count("Fig. 7: 75 steps at K = 100. Measured: 70 steps. Another start <b>") == 1
    assert "This report has 4 of 9 figures." in words
    assert "A line, x [length] & more." in words
    assert (stop("its reason"), stop("Its reason"), stop("")) == (";", ".", ".")


def test_the_contents_lead_to_every_figure(page: Page) -> None:
    anchors = {attributes["id"] for _, attributes in page.tags if "id" in attributes}
    links = [link["href"] or "" for link in page.all("a")]
    assert {link[1:] for link in links} <= anchors
    for entry in ENTRIES:
        assert f"#figure-{entry.key}" in links
    assert [h["id"] for h in page.all("h3") if "id" in h] == [f"figure-{e.key}" for e in ENTRIES]


def test_a_figure_that_failed_is_named_at_the_top_and_in_its_place(page: Page) -> None:
    words = " ".join(page.words.split())
    assert "1 figure could not be made and is missing from these counts: Fig. 13." in words
    assert "This figure could not be made: ZeroDivisionError: no reason" in words


def test_the_whole_report_does_not_speak_of_missing_figures(made: list[Made]) -> None:
    words = Page(report_html(made[:2], of=2)).words
    assert "This report has" not in words
    assert "could not be made" not in words
    assert "What does not hold" in words
    assert "What does not hold" not in Page(report_html(made[1:2], of=2)).words


def test_the_same_figures_give_the_same_report(made: list[Made], text: str) -> None:
    assert report_html(made, of=9) == text


@pytest.mark.parametrize(
    ("text", "html"),
    [
        (
            "f_u, x_12, ΔR·h_s/λ_max",
            "f<sub>u</sub>, x<sub>12</sub>, ΔR·h<sub>s</sub>/λ<sub>max</sub>",
        ),
        ("max_gain, time_s, a_b(c), q_[0], x_longer", None),
        ("3.1e-14 to 2e+05 or 1e-9", "3.1·10<sup>−14</sup> to 2·10<sup>5</sup> or 10<sup>−9</sup>"),
        ("0e+00, 0.0e-07, 1.5e+00", "0, 0, 1.5"),
        ("figure e12, 0x1e-9, e-5, 1e-9s, v1.2e3.4", None),
        ("x_f < <b>", "x<sub>f</sub> &lt; &lt;b&gt;"),
    ],
)
def test_indices_are_set_lower_and_powers_higher(text: str, html: str | None) -> None:
    assert typeset(text) == (text if html is None else html)


@pytest.mark.skipif(shutil.which("chromium") is None, reason="no chromium to show it with")
def test_a_browser_shows_it_on_a_phone(text: str, tmp_path: Path) -> None:
    """Nothing is wider than the page at 360 px, and every picture has been decoded."""
    (tmp_path / "report.html").write_text(text, encoding="utf-8")
    check = (
        "const f = document.querySelector('iframe'); f.onload = () => {"
        "const d = f.contentDocument, e = d.documentElement;"
        "const wide = e.scrollWidth > e.clientWidth ? 'too wide' : 'fits';"
        "const seen = [...d.images].filter(i => !i.closest('details'));"
        "seen.forEach(i => i.loading = 'eager');"
        "Promise.all(seen.map(i => i.decode())).then("
        "() => document.title = `${wide}: ${seen.length} pictures`,"
        "e => document.title = `broken ${e}`) }"
    )
    frame = '<iframe src="report.html" style="width: 360px; height: 740px; border: 0"></iframe>'
    (tmp_path / "phone.html").write_text(f"<title>-</title>{frame}<script>{check}</script>")
    shown = subprocess.run(
        [
            *("chromium", "--headless=new", "--no-sandbox", "--disable-gpu", "--dump-dom"),
            *("--allow-file-access-from-files", "--virtual-time-budget=8000"),
            *(f"--user-data-dir={tmp_path / 'profile'}", (tmp_path / "phone.html").as_uri()),
        ],
        capture_output=True,
        text=True,
        timeout=120,
        check=True,
    )
    assert "<title>fits: 3 pictures</title>" in shown.stdout
