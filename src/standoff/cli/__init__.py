"""The command line ``standoff``; `main` is its entry point."""

from standoff.cli.entry import main

__all__ = ["main"]
