"""Tests of behaviour set look-up and of the probabilities of alternatives."""

from pathlib import Path

import pytest

from kinesic.body.config import ConfigError
from kinesic.intent import behaviour_sets
from kinesic.intent.behaviour_sets import BehaviourSet, BehaviourSets, builtin_sets


def sets_of(*names: str, fallback: BehaviourSets | None = None) -> BehaviourSets:
    return BehaviourSets({name: BehaviourSet(name, (), frozenset()) for name in names}, fallback)


@pytest.mark.parametrize(
    ("name", "found"),
    [
        ("emotion-joy", "emotion-joy"),
        ("Emotion-JOY", "emotion-joy"),
        ("emotion-fear", "emotion-*"),
        ("emotion-fear-strong", "emotion-*"),
        ("emotion-joy-strong-very-much", "emotion-joy-*"),
        ("deictic-you", "Deictic-*"),
        ("emotion", None),
        ("motion-joy", None),
        ("a-" * 10_000, None),
    ],
)
def test_behaviour_set_is_found_by_name_or_category(name: str, found: str | None) -> None:
    sets = sets_of("emotion-joy", "emotion-joy-*", "emotion-*", "Deictic-*")
    behaviour_set = sets.find(name)
    assert (None if behaviour_set is None else behaviour_set.name) == found


def test_behaviour_set_of_the_longest_matching_category_is_found() -> None:
    found = sets_of("emotion-*", "emotion-joy-mild-*").find("emotion-joy-mild-late")
    assert found is not None
    assert found.name == "emotion-joy-mild-*"


def test_behaviour_set_missing_in_a_lexicon_is_found_in_its_fallback() -> None:
    sets = sets_of("emotion-joy", fallback=sets_of("emotion-*", "deictic-you"))
    assert [sets.find(name).name for name in ("emotion-joy", "emotion-fear", "deictic-you")] == [
        "emotion-joy",
        "emotion-*",
        "deictic-you",
    ]
    assert sets.find("nothing") is None


def read(text: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> BehaviourSets:
    path = tmp_path / "sets.toml"
    path.write_text(text)
    monkeypatch.setattr(behaviour_sets, "SET_FILES", (path,))
    return builtin_sets.__wrapped__()


def test_lexemes_without_a_probability_divide_the_remaining_probability(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    text = """
    [plain]
    gesture = ["BEAT", "SHRUG"]
    [mixed]
    gesture = [{name = "BEAT", probability = 0.4}, "SHRUG", "WAVE"]
    [full]
    gesture = [{name = "BEAT", probability = 0.8}, {name = "SHRUG", probability = 0.8}, "WAVE"]
    [rare]
    gesture = [{name = "BEAT", probability = 0.25, amount = 0.5, repetition = 2}]
    [again]
    same = "rare"
    """
    sets = read(text, tmp_path, monkeypatch)

    def probabilities(name: str) -> list[float]:
        (signal,) = sets.find(name).signals
        return [choice.probability for choice in signal.choices]

    assert probabilities("plain") == [0.5, 0.5]
    assert probabilities("mixed") == pytest.approx([0.4, 0.3, 0.3])
    assert probabilities("full") == [0.8, 0.8, 0.0]
    assert probabilities("rare") == probabilities("again") == [0.25]
    (signal,) = sets.find("again").signals
    assert (signal.choices[0].lexeme, signal.choices[0].amount, signal.choices[0].repetition) == ("BEAT", 0.5, 2)
    assert sets.find("again").name == "again"


@pytest.mark.parametrize("text", ['[a]\nsame = "b"', '[a]\nsame = "b"\n[b]\nsame = "c"\n[c]\ngesture = ["BEAT"]'])
def test_behaviour_set_that_copies_a_missing_or_copied_set_is_refused(text: str, tmp_path: Path, monkeypatch) -> None:
    with pytest.raises(ConfigError, match="behaviour set a is the same as b"):
        read(text, tmp_path, monkeypatch)
