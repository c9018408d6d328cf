"""Draw the pictures of docs/gallery.md by running the page's own code.

Run: python docs/images/make_gallery.py [FOLDER]. Needs matplotlib.
"""

import os
import re
import sys
from pathlib import Path

IMAGES = Path(__file__).parent
PAGE = IMAGES.parent / "gallery.md"


def main() -> None:
    target = Path(sys.argv[1] if len(sys.argv) > 1 else IMAGES).resolve()
    blocks = re.findall(
        r"^```python\n(.*?)^```$", PAGE.read_text("utf-8"), re.DOTALL | re.MULTILINE
    )
    names: dict[str, object] = {}
    os.chdir(target)
    for block in blocks:
        exec(compile(block, PAGE.name, "exec"), names)


if __name__ == "__main__":
    main()
