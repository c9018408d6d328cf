"""Print the table of breaks: ``python -m standoff_studies.paper.broken_on_purpose [--json]``."""

import argparse
import json

from standoff_studies.paper.broken_on_purpose.breaks import BREAKS
from standoff_studies.paper.broken_on_purpose.matrix import markdown, matrix


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
    given = parser.parse_args()
    found = matrix(one for one in BREAKS if one.key in given.only)
    if given.json:
        rows = {key: [one._asdict() for one in row] for key, row in found.items()}
        print(json.dumps(rows, indent=2, ensure_ascii=False))
    else:
        print(markdown(found))


if __name__ == "__main__":
    main()
