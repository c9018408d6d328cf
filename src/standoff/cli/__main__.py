"""``python -m standoff.cli``."""

import sys

from standoff.cli.entry import main

sys.exit(main())
