"""Print the table of breaks: ``python -m standoff_studies.paper.broken_on_purpose [--json]``.

``--promises`` prints which quotations of the promises turn, and by what.
"""

import argparse
import json
from collections.abc import Sequence

from standoff_studies.paper.broken_on_purpose.breaks import BREAKS
from standoff_studies.paper.broken_on_purpose.matrix import markdown, matrix


def promises(keys: Sequence[str]) -> str:
    """Make the changes of these figures and pages, or of all, and return what each turned."""
    from standoff_studies.paper.broken_on_purpose import changes

    made = [at for at in changes.CHANGES if at[0] in (keys or at) and changes.quoted(*at)]
    return changes.markdown(changes.turned_by(*at) for at in made)


def main() -> None:
    """Break the law in every way, which takes some minutes, and print what detects it."""
    parser = argparse.ArgumentParser(
        prog="python -m standoff_studies.paper.broken_on_purpose",
        description="Break the law of simulations A to E on purpose, one way after the other, and "
        "print which statements of which figure notice. It takes some minutes.",
    )
    parser.add_argument("--json", action="store_true", help="as JSON, not as Markdown")
    keys = [one.key for one in BREAKS]
    parser.add_argument("--only", nargs="+", choices=keys, default=keys, help="these breaks alone")
    parser.add_argument(
        "--promises",
        nargs="*",
        metavar="FIGURE",
        help="instead, make the changes that turn what docs/paper/promises.md quotes, of all "
        "figures and pages or of some, and print what each turned; all of it takes half an hour",
    )
    given = parser.parse_args()
    if given.promises is not None:
        print(promises(given.promises))
        return
    found = matrix(one for one in BREAKS if one.key in given.only)
    if given.json:
        rows = {key: [one._asdict() for one in row] for key, row in found.items()}
        print(json.dumps(rows, indent=2, ensure_ascii=False))
    else:
        print(markdown(found))


if __name__ == "__main__":
    main()
