"""Gestures that are read anew while a server runs."""

from dataclasses import replace

import pytest

from kinesic.body.config import ConfigError
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.expressivity.style.style import Style
from kinesic.planning.setup import Setup
from kinesic.serve.renewal import renew_setup


def test_only_the_gestures_are_new(known: Setup):
    present = replace(known, style=Style.load("calm"))
    lexicon = Lexicon.load()
    found = renew_setup(lambda: replace(known, lexicon=lexicon), present)
    assert found.lexicon is lexicon
    assert found.style is present.style
    assert found.robot is known.robot


@pytest.mark.parametrize("fault", [ConfigError("a wrong file"), FileNotFoundError("gone")])
def test_gestures_that_cannot_be_read_leave_all_as_it_was(
    known: Setup, capfd: pytest.CaptureFixture[str], fault: Exception
):
    def fail() -> Setup:
        raise fault

    assert renew_setup(fail, known) is known
    assert str(fault) in capfd.readouterr().err
