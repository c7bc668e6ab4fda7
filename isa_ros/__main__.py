"""`python -m isa_ros` is `isa`."""

import sys

from isa_ros.programs.isa import main

sys.exit(main())
