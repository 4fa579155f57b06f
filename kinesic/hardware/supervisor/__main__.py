"""`python -m kinesic.hardware.supervisor`."""

from kinesic.hardware.supervisor.process import main

raise SystemExit(main())
