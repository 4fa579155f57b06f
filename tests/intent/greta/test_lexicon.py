import os
import random
from itertools import pairwise
from pathlib import Path

import pytest

from kinesic.body.config import ConfigError
from kinesic.intent import choosing
from kinesic.intent.behaviour_sets import builtin_sets
from kinesic.intent.budget import STROKE_SPACINGS, MovementBudget
from kinesic.intent.choosing import choose_behaviours
from kinesic.intent.greta.agent import Agent
from kinesic.intent.greta.lexicon import read_lexicon
from kinesic.intent.intents import Intent, Moment
from kinesic.intent.sequences import draw_sequence

CORPUS_FOLDER = Path(os.environ.get("KINESIC_CORPUS", Path(__file__).parents[4] / "shared" / "corpus"))
LEXICON_XML = """<behaviorsets>
<behaviorset name="emotion-Odd"><signals>
  <signal id="1" name="faceexp=joy_signal_2" modality="face"><alternative name="none" probability="0.5"/></signal>
  <signal id="2" name="Nod_Big" modality="head"/>
  <signal id="3" name="gaze=look_down_left" modality="gaze"/>
  <signal id="4" name="deictic=me" modality="gesture"/>
  <signal id="5" name="tail" modality="tail"/>
</signals><constraints><core><item id="2"/></core><rules>
  <implication><ifpresent id="1"/><thennotpresent id="3"/></implication>
  <implication><ifpresent id="2"/><thenpresent id="4"/></implication>
</rules></constraints></behaviorset>
<behaviorset name="emotion-still"><signals><signal id="1" name="none" modality="face"/></signals>
<constraints><core><item id="1"/></core></constraints></behaviorset>
<behaviorset name="emotion-long" type="mse"><signals>
  <signal id="1" name="faceexp=fear" modality="face" min="1" max="2" probability_start="1" probability_end="0"/>
  <signal id="2" name="faceexp=anger" modality="face" min="1" max="2" probability_start="0" probability_end="1"/>
  <signal id="3" name="faceexp=joy" modality="face" excludelist="fear" min="1" max="1" repetitivity="1"/>
  <signal id="4" name="NOD" modality="head" min="2" max="3" repetitivity="1"/>
</signals></behaviorset></behaviorsets>"""


def intent(name, seconds=8.0):
    return Intent(name, Moment("1", 1.0), Moment("2", 2.0), Moment(f"{1 + seconds}", 1.0 + seconds), 1.0, "for a test")


@pytest.fixture(scope="module")
def sets(tmp_path_factory):
    path = tmp_path_factory.mktemp("greta") / "lexicon.xml"
    path.write_text(LEXICON_XML)
    return read_lexicon(path)


def shown(sets, seed):
    budget = MovementBudget(10, STROKE_SPACINGS, {})
    chosen = choose_behaviours([intent("emotion-odd")], sets, budget, seed=seed).behaviours
    return {item.channel: item for item in chosen}


def test_core_signals_of_a_greta_behaviour_set_have_a_higher_weight_than_its_other_signals(sets):
    behaviour_set = sets.find("emotion-odd")
    candidates = list(choosing._list_candidates(intent("emotion-odd"), behaviour_set, Agent(), random.Random(1)))
    bonus = {candidate.signal.id: candidate.weight - 1.0 for candidate in candidates}
    assert bonus.pop("2") == pytest.approx(choosing.CORE_BONUS)
    assert bonus
    assert set(bonus.values()) == {0.0}


def test_random_greta_signals_obey_the_constraints_of_their_behaviour_set(sets):
    all_of_them = [shown(sets, seed) for seed in range(40)]
    with_face = [item for item in all_of_them if "face" in item]
    assert 8 < len(with_face) < 32, "half of them show nothing"
    assert all(("gaze" in item) is ("face" not in item) for item in all_of_them), "the face forbids the gaze"
    assert {item["gesture"].lexeme for item in all_of_them} == {"me"}, "the core demands the gesture"
    head = all_of_them[0]["head"]
    assert (head.lexeme, head.amount) == ("NOD", 0.9)
    assert with_face[0]["face"].lexeme == "joy", "a part of an expression is the whole"
    assert {item["gaze"].lexeme for item in all_of_them if "gaze" in item} == {"DOWNLEFT"}


def test_sequence_of_greta_signals_fills_the_duration_of_the_intention(sets):
    result = sets.find("emotion-long")
    for seed in range(20):
        drawn = list(draw_sequence(intent("emotion-long"), result, random.Random(seed)))
        faces = [(part, signal) for part, signal in drawn if signal.channel == "face"]
        ids = [signal.id for _, signal in faces]
        assert ids.count("1") <= 1
        assert ids.count("2") <= 1
        assert not {"1", "3"} <= set(ids), "one excludes the other"
        heads = [part for part, signal in drawn if signal.channel == "head"]
        assert heads[0].start.seconds == 1.0
        assert heads[-1].end.seconds == pytest.approx(9.0, abs=0.6)
        for before, after in pairwise(heads):
            assert after.start.seconds == pytest.approx(before.end.seconds)
        assert all(part.start.seconds < part.stroke.seconds < part.end.seconds for part, _ in drawn)


def test_greta_signals_marked_unrepeatable_are_shown_once(sets):
    """Expect fear and anger once, and joy repeatedly unless fear excludes joy."""
    result, seen = sets.find("emotion-long"), []
    for seed in range(20):
        drawn = draw_sequence(intent("emotion-long"), result, random.Random(seed))
        ids = [signal.id for _, signal in drawn if signal.channel == "face"]
        if "3" not in ids:
            seen.append(ids)
            assert sorted(ids) == ["1", "2"]
    assert seen


@pytest.mark.parametrize("move", ["nod", "shake"])
def test_greta_head_movements_without_size_have_the_middle_amount(tmp_path, move):
    sizes = [f"{move}_{size}" for size in ("small", "middle", "big")]
    others = [f"{move}1", *{"nod": ["NodUpDown", "NodDownUp"], "shake": ["ShakeLeftRight", "ShakeRightLeft"]}[move]]
    signals = "".join(f'<signal id="{name}" name="{name}" modality="head"/>' for name in (*sizes, *others))
    path = tmp_path / "heads.xml"
    path.write_text(f'<behaviorsets><behaviorset name="x"><signals>{signals}</signals></behaviorset></behaviorsets>')
    choices = [signal.choices[0] for signal in read_lexicon(path).sets["x"].signals]
    assert {choice.lexeme for choice in choices} == {move.upper()}
    small, middle, big, *rest = (choice.amount for choice in choices)
    assert 0.0 < small < middle < big < 1.0
    assert rest == [middle] * len(others)


def test_probabilities_and_times_of_greta_signals_are_read(sets):
    face = sets.sets["emotion-Odd"].signals[0]
    assert [(choice.lexeme, choice.probability) for choice in face.choices] == [("joy", 0.5), ("none", 0.5)]
    first, _, third, _ = (signal.spell for signal in sets.sets["emotion-long"].signals)
    assert (first.least, first.most, first.early, first.late, first.repeats) == (1.0, 2.0, 1.0, 0.0, False)
    assert (third.early, third.late, third.repeats, third.excludes) == (0.5, 0.5, True, {"fear"})


def test_empty_greta_behaviour_set_is_reported_as_reason_of_omission(sets):
    omitted = choose_behaviours([intent("theme-x")], sets, MovementBudget(10, STROKE_SPACINGS, {})).omissions
    assert [item.why for item in omitted] == ["the set of theme-x is empty"]


def test_greta_signal_without_lexeme_gives_no_behaviour(sets):
    assert choose_behaviours([intent("emotion-still")], sets, MovementBudget(10, STROKE_SPACINGS, {})).behaviours == ()


def test_behaviour_sets_missing_in_a_greta_lexicon_are_taken_from_the_built_in_sets(sets):
    assert sets.find("performative-greet") is builtin_sets().find("performative-greet")
    assert sets.find("EMOTION-odd") is sets.sets["emotion-Odd"]


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("<profile/>", "<profile> where <behaviorsets>"),
        ("<behaviorsets>", "no element found"),
        ("<behaviorsets><behaviorset/></behaviorsets>", "without a name"),
        (LEXICON_XML.replace('probability="0.5"', 'probability="nan"'), "'nan' in <alternative> is no number"),
    ],
)
def test_invalid_greta_lexicon_files_are_refused(tmp_path, text, says):
    path = tmp_path / "wrong.xml"
    path.write_text(text)
    with pytest.raises(ConfigError, match=says):
        read_lexicon(path)


@pytest.mark.skipif(not CORPUS_FOLDER.is_dir(), reason=f"no corpus at {CORPUS_FOLDER}")
def test_every_behaviour_set_of_the_greta_lexicons_gives_behaviours_or_a_reason():
    paths = sorted((CORPUS_FOLDER / "greta/behaviorplanner/IntentionLexicon").glob("*.xml"))
    assert len(paths) == 4
    for path in paths:
        sets = read_lexicon(path)
        for name, result in sets.sets.items():
            chosen = choose_behaviours([intent(name)], sets, MovementBudget(10, STROKE_SPACINGS, {}))
            lexemes = {choice.lexeme for signal in result.signals for choice in signal.choices}
            assert chosen.behaviours or chosen.omissions, name
            assert {behaviour.lexeme for behaviour in chosen.behaviours} <= lexemes
