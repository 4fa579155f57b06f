"""The voice that tests of speech share."""

import pytest

from kinesic.speech.engine import fault
from kinesic.speech.espeak import Espeak


@pytest.fixture(scope="session")
def espeak() -> Espeak:
    """The engine; tests that need it are skipped where it is missing."""
    if why := fault():
        pytest.skip(why)
    return Espeak()
