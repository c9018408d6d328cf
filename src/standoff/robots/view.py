"""`robot.view`: a robot in the browser, at a configuration or along a path."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from standoff.robots.proof import PathProof
from standoff.robots.robot_model import RobotModel
from standoff.robots.shown_robot import shown_robot

if TYPE_CHECKING:
    from standoff.robots.robot_page import RobotPage


def view(
    robot: RobotModel,
    what: Any,
    *,
    times: Any = None,
    proof: PathProof | None = None,
    host: str = "127.0.0.1",
    port: int | None = None,
    open: bool = True,
) -> RobotPage:
    """Show a robot in the browser (docs/robots.md).

    Raises ModuleNotFoundError: viser is not installed, or with a proof matplotlib; the message
    names the extra. Raises TypeError: a proof that is none. Raises ValueError: a configuration or a
    path of another size; a proof of another path, or of none; a port that is not available.

    Parameters
    ----------
    robot : Robot
    what : (nq,) array, or a path as ``certify`` takes it
        A configuration, or what is played.
    times : (n,) array, optional
        Of the waypoints [s]; 0, 1, 2, ... if not given.
    proof : PathProof, optional
        What ``robot.certify`` returned of this path: its steps are drawn.
    host : str
        Name or address to serve the page at; only this machine, if not given.
    port : int, optional
        Any that is free, if not given.
    open : bool
        Open the page in the usual browser.

    Returns
    -------
    RobotPage
        It serves until ``close``, or until the end of its ``with`` block; open its ``address``. In
        a notebook it shows itself.
    """
    from standoff.robots.robot_page import RobotPage

    page = RobotPage(shown_robot(robot, what, times, proof), host=host, port=port)
    if open:
        import webbrowser

        webbrowser.open(page.address)
    return page
