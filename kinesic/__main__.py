"""Command line entry point for `python -m kinesic`."""

from kinesic.cli import main

main()
