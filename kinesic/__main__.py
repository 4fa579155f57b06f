"""`python -m kinesic` is the command line."""

from kinesic.cli import main

main()
