"""Machine code that a wheel carries: used if it certainly fits; if not, a message says so once.

`shipping` writes it: a manifest, and a file for each compiled module (an entry, or a kernel that
several entries share). If anything does not fit, the kernels are compiled as usual.
"""

from __future__ import annotations

import hashlib
import json
import pickle
import sys
from functools import lru_cache
from typing import Any

import llvmlite
import numba
from numba.core import config, sigutils

from standoff.kernels.compiler import machine, modules
from standoff.kernels.compiler.notices import say
from standoff.kernels.compiler.trust import others_can_write

FOLDER = machine.KERNELS / "compiled"
"""Looked at once, when the first machine code is needed."""

MANIFEST = "manifest.json"


def load(function: Any, signature: Any) -> Any:
    """What is stored of a module, or None.

    Parameters
    ----------
    function : Any
        That was compiled: an entry's or a shared kernel's, in Python.
    signature : Any
        The types of its arguments, as `compile` of a dispatcher takes them.
    """
    carried = _carried()
    if not carried:
        return None
    file, digest = carried.get(key_of(function, signature), (None, None))
    if file is None:
        return None
    try:
        data = (FOLDER / file).read_bytes()
        if hashlib.sha256(data).hexdigest() != digest:
            raise ValueError("not what was written")
        return pickle.loads(data)
    except Exception as error:  # whatever unpickling meets
        carried.clear()
        _refuse(f"{FOLDER / file} is damaged ({error})")
        return None


def key_of(function: Any, signature: Any) -> str:
    arguments, _ = sigutils.normalize_signature(signature)
    return f"{function.__module__}.{function.__qualname__}{tuple(arguments)}"


@lru_cache(maxsize=1)
def _carried() -> dict[str, list[str]]:
    """File and digest of each module that can be used."""
    try:
        manifest = json.loads((FOLDER / MANIFEST).read_bytes())
        why, carried = misfit(manifest), dict(manifest["modules"])
    except FileNotFoundError:
        if not FOLDER.is_dir():
            return {}
        why, carried = f"{FOLDER} has no {MANIFEST}", {}
    except Exception as error:  # whatever a damaged manifest gives
        why, carried = f"{FOLDER / MANIFEST} is damaged ({error!r})", {}
    if why is not None:
        _refuse(why)
        return {}
    return carried


def misfit(manifest: dict[str, Any]) -> str | None:
    """Why the machine code that a manifest describes cannot be used here, or None."""
    for what, here in made_by().items():
        if manifest[what] != here:
            return f"it is for {what} {manifest[what]}, and this is {here}"
    lacking = machine.lacking(manifest["features"])
    if lacking is not None:
        return f"it is for the processor {manifest['processor']}, and {lacking}"
    if machine.bounds_checked():
        return "STANDOFF_BOUNDS_CHECK is set"
    if not modules.AVAILABLE:
        return f"{modules.FORCE_STOCK} is set"
    if manifest["sources"] != machine.source_digest():
        return "it was compiled from other sources of the kernels"
    unsafe = others_can_write(FOLDER.resolve())
    if unsafe is not None:
        return (
            f"{unsafe}, and the machine code in it would be run; remove that permission (chmod "
            "go-w)"
        )
    return None


def made_by() -> dict[str, str]:
    """What must be the same where it is made and where it is used."""
    return {
        "Python": str(sys.implementation.cache_tag),
        "Numba": numba.__version__,
        "llvmlite": llvmlite.__version__,
        "system": machine.system(),
        "NUMBA_OPT": str(getattr(config.OPT, "_raw_value", config.OPT)),  # "max" too equals 3
    }


def _refuse(why: str) -> None:
    say(f"not using the machine code of the wheel: {why}. The kernels are compiled instead.")
