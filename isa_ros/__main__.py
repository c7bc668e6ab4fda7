"""`python -m isa_ros` is `isa`."""

import sys

from isa_ros.cli.main import main

sys.exit(main())
