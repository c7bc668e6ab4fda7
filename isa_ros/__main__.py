"""`python -m isa_ros` is `isa`."""

import sys

from isa_ros.cli import main

sys.exit(main())
