"""Reload of the gesture lexicon while the server runs."""

import traceback
from collections.abc import Callable
from dataclasses import replace

from kinesic.body.config import ConfigError
from kinesic.planning.setup import Setup


def renew_setup(make_setup: Callable[[], Setup], setup: Setup) -> Setup:
    """Return a setup with the reloaded lexicon, unchanged if it is unreadable.

    Args:
        make_setup: creates another setup.
        setup: current setup, whose robot, style and targets are kept.
    """
    try:
        return replace(setup, lexicon=make_setup().lexicon)
    except (ConfigError, OSError) as error:
        traceback.print_exception(error)
        return setup
