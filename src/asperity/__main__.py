"""Run the command line: ``python -m asperity``."""

import sys

from asperity.app.cli import main

sys.exit(main())
