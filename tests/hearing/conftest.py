"""Fixtures of the hearing tests."""

import pytest

from kinesic.speech.espeak import Espeak
from kinesic.speech.espeak_pool import espeak_fault


@pytest.fixture(scope="session")
def espeak() -> Espeak:
    """Return an espeak-ng voice, or skip the test if it is missing."""
    if why := espeak_fault():
        pytest.skip(why)
    return Espeak()
