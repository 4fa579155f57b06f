"""`python -m kinesic` is the command line."""

from kinesic.controller.cli import main

main()
