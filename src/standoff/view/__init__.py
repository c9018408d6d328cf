"""A scene in the browser, by viser: the live page; and runs as files that show them."""

from typing import TYPE_CHECKING

from standoff.on_demand import on_demand

if TYPE_CHECKING:
    from standoff.view.export import page_of, save_page
    from standoff.view.opening import view
    from standoff.view.rerun_log import save_rerun
    from standoff.view.video import save_video
else:
    __getattr__, __dir__ = on_demand(__name__)

__all__ = ["page_of", "save_page", "save_rerun", "save_video", "view"]
