"""A scene in the browser, by viser: the live page (docs/live-page.md)."""

from standoff.view.opening import view as view

__all__ = ["view"]
