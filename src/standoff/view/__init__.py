"""A scene in the browser, by viser: the live page (docs/live-page.md)."""
