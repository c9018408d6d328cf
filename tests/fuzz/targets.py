"""What is fuzzed: for each target its corpus, how inputs are drawn, and the law they must keep."""

from __future__ import annotations

import hashlib
import shutil
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from random import Random

from fuzz.files import check_file, file_input
from fuzz.geometry import check_geometry, geometry_input
from fuzz.scenes import check_scene, scene_input

CORPUS = Path(__file__).parent / "corpus"
Input = tuple[str, bytes]
"""Name, whose ending says the format, and content."""


@dataclass(frozen=True)
class Target:
    """One thing that is fuzzed.

    Attributes
    ----------
    name : str
        Also the folder of its corpus: seeds, and inputs that once failed.
    draw : callable
        A new input from the corpus and a source of chance.
    check : callable
        Tries an input within a folder of its own; a word, or `laws.Broken`.
    """

    name: str
    draw: Callable[[dict[str, bytes], Random], Input]
    check: Callable[[str, bytes, Path], str]

    @property
    def folder(self) -> Path:
        return CORPUS / self.name

    def corpus(self) -> dict[str, bytes]:
        """Return every input kept, by its name."""
        return {p.name: p.read_bytes() for p in sorted(self.folder.iterdir()) if p.is_file()}

    def prepare(self, folder: Path) -> Path:
        """Return a folder with the files that inputs may name."""
        beside = self.folder / "files"
        for file in beside.iterdir() if beside.is_dir() else ():
            shutil.copy(file, folder)
        return folder

    def keep(self, name: str, content: bytes) -> Path:
        """Add an input that failed to the corpus."""
        digest = hashlib.sha256(content).hexdigest()[:10]
        stem, ending = Path(name).stem.split("-")[0], Path(name).suffix
        file = self.folder / f"{stem}-{digest}{ending}"
        file.write_bytes(content)
        return file


def _scene(corpus: dict[str, bytes], random: Random) -> Input:
    return "found.toml", scene_input(list(corpus.values()), random)


def _geometry(corpus: dict[str, bytes], random: Random) -> Input:
    return "found.json", geometry_input(list(corpus.values()), random)


TARGETS = {
    target.name: target
    for target in (
        Target("scene", _scene, lambda name, content, folder: check_scene(content, folder)),
        Target("geometry", _geometry, lambda name, content, folder: check_geometry(content)),
        Target("files", file_input, check_file),
    )
}


def check_once(target: Target, name: str, content: bytes) -> str:
    """Try one input in a new folder, which is gone afterwards."""
    with tempfile.TemporaryDirectory() as folder:
        return target.check(name, content, target.prepare(Path(folder)))
