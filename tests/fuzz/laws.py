"""What must hold for any input: an answer, or an exception raised on purpose, soon.

A law returns a word about what happened ("scene", "refused", ...), and raises `Broken` where the
library kept none of its promises: an exception that it did not mean to raise, a number that is
none, an answer on the wrong side of an independent bound, a changed folder or argument.
"""

from __future__ import annotations

import contextlib
import linecache
import signal
import traceback
import warnings
from collections.abc import Iterator
from json import JSONDecodeError
from pathlib import Path
from tomllib import TOMLDecodeError
from types import FrameType

LIBRARY = str(Path(__file__).resolve().parents[2] / "src" / "standoff")
SECONDS = 240.0
"""Most time for one input in the suite, where the first of a kind may compile its kernels. The long
command allows ten seconds."""


class Broken(AssertionError):
    """A law that does not hold; the message says which."""


class Hang(BaseException):
    """Raised by the watchdog; no library catches it."""


@contextlib.contextmanager
def watchdog(seconds: float = SECONDS) -> Iterator[None]:
    """Turn a hang of Python code into `Broken`; a hang of compiled code only an outer one ends."""

    def ring(number: int, frame: FrameType | None) -> None:
        raise Hang("".join(traceback.format_stack(frame)[-3:]))

    before = signal.signal(signal.SIGALRM, ring)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    except Hang as hang:
        raise Broken(f"no end after {seconds:g} s, at {hang}") from None
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)


def meant(error: BaseException) -> bool:
    """Was it raised by a `raise` of the library, not by an operation that went wrong?

    An error that repeats another's words, as those of scenes do, is as good as that other. What
    the parsers of TOML, JSON and Parquet say of a file is good as it is.
    """
    inner = error.__cause__
    if inner is not None and str(inner) and str(error).endswith(str(inner)):
        parsers = OSError | TOMLDecodeError | JSONDecodeError | UnicodeDecodeError
        foreign = isinstance(inner, parsers) or type(inner).__module__.startswith("pyarrow")
        return foreign or meant(inner)
    last = traceback.extract_tb(error.__traceback__)[-1]
    line = linecache.getline(last.filename, last.lineno or 0).strip()
    return last.filename.startswith(LIBRARY) and line.startswith("raise ")


@contextlib.contextmanager
def refusals(kinds: tuple[type[BaseException], ...]) -> Iterator[list[str]]:
    """Collect the message of a refusal; any other exception, and any warning, is `Broken`."""
    said: list[str] = []
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            yield said
        except Broken:
            raise
        except kinds as error:
            if not meant(error) or not str(error).strip():
                raise Broken(f"not meant: {_told(error)}") from error
            said.append(str(error))
        except Exception as error:
            raise Broken(f"undocumented: {_told(error)}") from error


def _told(error: BaseException) -> str:
    inner: BaseException = error
    while inner.__cause__ is not None:
        inner = inner.__cause__
    frames = [f for f in traceback.extract_tb(inner.__traceback__) if "standoff" in f.filename]
    where = ""
    if frames:
        where = f" at {Path(frames[-1].filename).name}:{frames[-1].lineno} {frames[-1].line}"
    return f"{type(error).__name__}: {str(error)[:300]}{where}"
