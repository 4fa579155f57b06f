"""Tests of messages about unknown FML intentions."""

import pytest

from kinesic.intent.behaviour_sets import BehaviourSet, BehaviourSets, builtin_sets
from kinesic.intent.fml.author import author_fml
from kinesic.intent.fml.names import explain_unknown


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("emotion-joyx", "emotion has no type joyx; did you mean joy?"),
        ("certainty-certainx", "certainty has no type certainx; did you mean certain?"),
        ("certainty-zzz", "certainty has no type zzz; known: certain, uncertain"),
        ("deicticx-you", "element deicticx is unknown; did you mean deictic?"),
        ("emotion-JOY", ""),
        ("Emotion-joy", ""),
        ("emotion-any", ""),
        ("belief-relation-enumerate", ""),
        ("theme-rest", ""),
    ],
)
def test_unknown_intention_is_explained_with_the_nearest_known_name(name: str, message: str) -> None:
    assert explain_unknown(name, builtin_sets()) == message


def test_types_of_the_fallback_lexicon_are_known() -> None:
    own = BehaviourSets({"mood-calm": BehaviourSet("mood-calm", ())}, builtin_sets())
    assert explain_unknown("emotion-joy", own) == ""
    assert explain_unknown("mood-calmer", own) == "mood has no type calmer; did you mean calm?"


def test_warning_about_an_unknown_type_has_its_line_and_what_is_shown() -> None:
    text = (
        '<fml-apml><fml>\n <emotion type="joyx" start="0" end="3"/>\n <deicticx type="you" start="4"/></fml></fml-apml>'
    )
    assert author_fml(text)[1] == (
        "taken as any emotion: emotion-joyx, <emotion> at 2:2: emotion has no type joyx; did you mean joy?",
        "not shown: deicticx-you, <deicticx> at 3:2: element deicticx is unknown; did you mean deictic?",
    )
