"""The voice that tests of speech share."""

import pytest

from kinesic.speech.espeak import Espeak
from kinesic.speech.espeak_pool import espeak_fault


@pytest.fixture(scope="session")
def espeak() -> Espeak:
    """The engine; tests that need it are skipped where it is missing."""
    if why := espeak_fault():
        pytest.skip(why)
    return Espeak()
