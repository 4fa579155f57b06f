"""Reads anew which gestures are known; everything else of a setup stays as it was when the server began."""

import traceback
from collections.abc import Callable
from dataclasses import replace

from kinesic.body.config import ConfigError
from kinesic.planning.setup import Setup


def renew_setup(make_setup: Callable[[], Setup], known: Setup) -> Setup:
    """Gives a setup the gestures that are known now; where they cannot be read, it stays as it is.

    Args:
        make_setup: makes another setup.
        known: the present one, whose robot, style and targets stay.
    """
    try:
        return replace(known, lexicon=make_setup().lexicon)
    except (ConfigError, OSError) as error:
        traceback.print_exception(error)
        return known
