"""``standoff cache``: what is kept of CAD files, and where."""

from __future__ import annotations

from standoff import __version__
from standoff.cad import store
from standoff.cli.arguments import CacheCommand
from standoff.cli.errors import CommandError, ExitCode, WriteError
from standoff.cli.terminal import tell
from standoff.errors import StandoffError
from standoff.wording import counted


def run_cache(command: CacheCommand) -> int:
    """Tell, or remove what is kept.

    Raises CommandError: the environment gives no size, or no folder. Raises WriteError if a file
    could not be removed.
    """
    try:
        most, folder = store.most_bytes(), store.folder()
    except (StandoffError, OSError) as error:
        raise CommandError(str(error)) from error
    try:
        removed = store.clear() if command.clear else 0
    except OSError as error:
        raise WriteError(f"not all was removed: {error}") from error
    files = store.entries()
    size = sum(entry.size for entry in files)
    if command.json:
        from standoff.cli.facts import json_text

        facts = {"folder": str(folder), "files": len(files), "bytes": size, "most_bytes": most}
        tell(json_text({"standoff": __version__} | facts | {"removed": removed}))
        return ExitCode.DONE
    if command.clear:
        tell(f"removed {counted(removed, 'file')}")
    limit = f"of at most {most / 1e6:g} MB" if most else f"not used, as {store.SIZE} is 0"
    kept = f"{counted(len(files), 'file')}, {size / 1e6:.1f} MB"
    tell(f"finished parts: {kept}, {limit}, in {folder}")
    return ExitCode.DONE
