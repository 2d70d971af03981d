"""`python -m horizon_dl` is `horizon-dl`."""

import sys

from horizon_dl.cli import main

sys.exit(main())
