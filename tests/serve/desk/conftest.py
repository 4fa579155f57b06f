"""Setups for planning, created once."""

from dataclasses import replace

import pytest

from kinesic.planning.setup import Setup
from kinesic.session.setup import set_up
from kinesic.speech.espeak_pool import espeak_fault
from kinesic.speech.voice import voice


@pytest.fixture(scope="package")
def upper22_setup() -> Setup:
    return set_up()


@pytest.fixture(scope="package")
def speaking_setup(upper22_setup: Setup) -> Setup:
    """Setup with an audible voice."""
    if fault := espeak_fault():
        pytest.skip(fault)
    return replace(upper22_setup, voice=voice("espeak"))
