"""Packs a folder of compiled kernels into the wheel: see docs/wheels.md.

Without STANDOFF_COMPILED in the environment this does nothing, and the wheel is one for every
platform, which compiles its kernels at the first use.
"""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface


class CompiledKernels(BuildHookInterface):
    """Where STANDOFF_COMPILED names a folder, a wheel for this Python, platform and Numba."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        folder = os.environ.get("STANDOFF_COMPILED")
        if not folder or version == "editable":
            return
        manifest = json.loads((Path(folder) / "manifest.json").read_text())
        build_data["pure_python"] = False
        build_data["infer_tag"] = True
        build_data["force_include"][folder] = "standoff/kernels/compiled"
        build_data["dependencies"] = [
            f"numba=={manifest['Numba']}",
            f"llvmlite=={manifest['llvmlite']}",
        ]
