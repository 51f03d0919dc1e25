"""``python -m logical_robots_tui`` is ``logical-robots``."""

import sys

from logical_robots_tui.supervisor import main

if __name__ == "__main__":
    sys.exit(main())
