"""What planning needs, made once."""

from dataclasses import replace

import pytest

from kinesic.controller.perform import set_up
from kinesic.planning.setup import Setup
from kinesic.speech.espeak_pool import espeak_fault
from kinesic.speech.voice import voice


@pytest.fixture(scope="package")
def upper22_setup() -> Setup:
    return set_up()


@pytest.fixture(scope="package")
def speaking_setup(upper22_setup: Setup) -> Setup:
    """One whose voice is heard."""
    if fault := espeak_fault():
        pytest.skip(fault)
    return replace(upper22_setup, voice=voice("espeak"))
