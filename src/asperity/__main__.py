"""Run the command line: ``python -m asperity``."""

import sys

from asperity.cli import main

sys.exit(main())
