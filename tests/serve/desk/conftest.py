"""What planning needs, made once."""

import pytest

from kinesic.controller.perform import set_up
from kinesic.planning.setup import Setup


@pytest.fixture(scope="package")
def upper22_setup() -> Setup:
    return set_up()
