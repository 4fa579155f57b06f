"""Lexicon reloads while a server runs."""

from dataclasses import replace

import pytest

from kinesic.body.config import ConfigError
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.expressivity.style.style import Style
from kinesic.planning.setup import Setup
from kinesic.serve.renewal import renew_setup


def test_reload_of_the_lexicon_keeps_robot_and_style(known: Setup):
    present = replace(known, style=Style.load("calm"))
    lexicon = Lexicon.load()
    renewed = renew_setup(lambda: replace(known, lexicon=lexicon), present)
    assert renewed.lexicon is lexicon
    assert renewed.style is present.style
    assert renewed.robot is known.robot


@pytest.mark.parametrize("fault", [ConfigError("a wrong file"), FileNotFoundError("gone")])
def test_failed_lexicon_reload_keeps_the_old_lexicon(known: Setup, capfd: pytest.CaptureFixture[str], fault: Exception):
    def fail() -> Setup:
        raise fault

    assert renew_setup(fail, known) is known
    assert str(fault) in capfd.readouterr().err
