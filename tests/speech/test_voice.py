import pickle

import pytest

from kinesic.bml.parse import parse
from kinesic.body.config import ConfigError
from kinesic.controller.perform import plan, set_up
from kinesic.expressivity.style.style import Expressivity, Style
from kinesic.planning.speech import delivery, synthesise_block
from kinesic.speech import voice as module
from kinesic.speech.espeak_pool import espeak_fault
from kinesic.speech.voice import voice

SPEECH = (
    '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">'
    '<speech id="s"><text>Hello, my <sync id="m"/>friend</text></speech></bml>'
)


def test_auto_speaks_where_an_engine_is_installed():
    if espeak_fault():
        pytest.skip(espeak_fault())
    said = plan(SPEECH, set_up(voice="auto")).utterances["s"]
    assert said.voice == "espeak-ng"
    assert said.sound is not None
    assert said.sound.duration == pytest.approx(said.duration)


def test_auto_is_silent_elsewhere_and_warns(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(module, "espeak_fault", lambda: "espeak-ng is not installed: pip install it")
    planned = plan(SPEECH, set_up(voice="auto"))
    assert planned.utterances["s"].voice == "durations"
    (notice,) = planned.notices
    assert notice.id == "b:s"
    assert "pip install it" in notice.text


def test_an_engine_asked_for_by_name_must_be_there(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(module, "espeak_fault", lambda: "espeak-ng is not installed: pip install it")
    with pytest.raises(ConfigError, match="pip install it"):
        voice("espeak")


def test_the_library_is_silent_and_says_nothing_of_it_unless_asked():
    planned = plan(SPEECH, set_up())
    assert planned.utterances["s"].sound is None
    assert planned.notices == ()


@pytest.mark.parametrize("name", ["auto", "durations"])
def test_a_voice_can_go_to_another_process(name: module.VoiceName):
    block = parse(SPEECH)
    ours, theirs = set_up(voice=name), set_up()
    object.__setattr__(theirs, "voice", pickle.loads(pickle.dumps(ours.voice)))
    assert synthesise_block(block, theirs)["s"].marks == synthesise_block(block, ours)["s"].marks


def test_a_neutral_style_speaks_as_the_voice_does():
    assert delivery(Style()) == (1.0, 1.0)


@pytest.mark.parametrize(
    ("manner", "faster", "higher"),
    [
        (Expressivity(temporal=1.0), True, None),
        (Expressivity(temporal=-1.0), False, None),
        (Expressivity(power=1.0), None, True),
        (Expressivity(activation=-1.0), None, False),
    ],
)
def test_manner_changes_rate_and_pitch(manner: Expressivity, faster: bool | None, higher: bool | None):
    for value, expected in zip(delivery(Style.uniform(manner)), (faster, higher), strict=True):
        assert (value > 1.0, value < 1.0) == {None: (False, False), True: (True, False), False: (False, True)}[expected]


def test_a_fast_style_is_heard_sooner():
    calm, fast = (
        plan(SPEECH, set_up(style=Style.uniform(Expressivity(temporal=t)))).utterances["s"].duration
        for t in (-1.0, 1.0)
    )
    assert calm / fast == pytest.approx(1.25**2)
