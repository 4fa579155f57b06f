"""Tests of denials and idioms in languages without cues."""

import pytest

from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.expressivity.style.style import Style
from kinesic.intent.author import plan_behaviours

LEXICON, NEUTRAL = Lexicon.load(), Style.load("neutral")
REFUSALS = {"set_aside", "no_low", "no_wag", "refuse_sweep", "refuse_push", "crossed_out"}


def shown(text: str, language: str, channel: str) -> set[str]:
    """Return the lexemes of one channel for a text."""
    _, selection = plan_behaviours(text, LEXICON, NEUTRAL, language=language, seed=0)
    return {behaviour.lexeme for behaviour in selection.behaviours if behaviour.channel == channel}


@pytest.mark.parametrize(
    ("language", "text"),
    [("de", "Warum nicht?"), ("de", "Ich habe keine Ahnung."), ("fr", "C'est pas mal du tout."),
     ("fr", "Pourquoi pas ?"), ("es", "De nada, no hay problema."), ("es", "No tengo ni idea."),
     ("it", "Non vedo l'ora di partire."),
     ("it", "Niente male davvero!"), ("pt", "Não faço ideia."), ("nl", "Waarom niet?"),
     ("nl", "Geen idee waar hij is."),
     ("ja", "すみません、おくれました。"), ("ja", "もんだいありません。")],
)  # fmt: skip
def test_idioms_with_negative_words_get_no_head_shake_and_no_refusal_gesture(language: str, text: str):
    assert "SHAKE" not in shown(text, language, "head")
    assert not shown(text, language, "gesture") & REFUSALS


@pytest.mark.parametrize(
    ("language", "text"),
    [("de", "Nein, das stimmt so."), ("fr", "Non, merci."), ("es", "No, eso es falso."), ("it", "No, è falso."),
     ("pt", "Não, isso é falso."), ("nl", "Nee, dat is fout."), ("ja", "いいえ、ちがいます。")],
)  # fmt: skip
def test_refusal_at_the_start_of_a_sentence_gets_a_head_shake_and_a_refusal_gesture(language: str, text: str):
    assert "SHAKE" in shown(text, language, "head")
    assert shown(text, language, "gesture") & REFUSALS


def test_german_denial_within_a_statement_gets_a_head_shake_but_no_refusal_gesture():
    text = "Im Haus war gestern niemand."
    assert "SHAKE" in shown(text, "de", "head")
    assert not shown(text, "de", "gesture") & REFUSALS


def test_name_no_after_a_title_gets_no_head_shake():
    assert "SHAKE" not in shown("We met Dr. No there.", "en", "head")
    assert "SHAKE" in shown("We met no doctor there.", "en", "head")
