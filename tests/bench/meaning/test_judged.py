import importlib.util
from pathlib import Path

import pytest

from kinesic.bench.blocks import find_corpus
from kinesic.bench.meaning import judged
from kinesic.bench.meaning.judging import JudgedSet, JudgedUtterance, ShownGesture, judge_utterance, load_judged

SENTENCE_FOLDER = (find_corpus() or Path("absent")) / "sentences"
TABLE_HEADER = "id\ttext\taccepted\tbeat_ok\tnone_ok\tmisleading\ttags\n"


@pytest.fixture
def small_set(tmp_path):
    """Return two utterances, of which the first needs a meaningful gesture."""
    (tmp_path / "kinds.tsv").write_text("kind\tids\nany beat\tbeat\nany rest\thands_low\nany stop\tstop stop_low\n")
    rows = (
        "s001\tNo, no. The big one!\tlarge@big, no_low@no#2\t1\t0\tany stop except stop_low, face:joy, left@one\ttrap",
        "s002\tThe bus is late.\t\t0\t1\thead:shake, stop\tplain",
    )
    (tmp_path / "sentences.tsv").write_text(TABLE_HEADER + "\n".join(rows) + "\n")
    return load_judged(tmp_path)


def verdict(small: JudgedSet, number: int, *gestures: tuple[str, int], faces=(), heads=()):
    shown = [ShownGesture(*gesture) for gesture in gestures]
    result = judge_utterance(small.utterances[number], small, shown, set(faces), set(heads))
    return result.verdict, result.has_hit, result.merit


def test_judgement_of_a_chosen_gesture_depends_on_its_kind_and_word(small_set):
    assert verdict(small_set, 0, ("large", 4)) == ("right", True, 1.0)
    assert verdict(small_set, 0, ("large", 1)) == ("neutral", False, 0.0), "off its word"
    assert verdict(small_set, 0, ("no_low", 1)) == ("right", True, 1.0)
    assert verdict(small_set, 0, ("beat", 0)) == ("right", False, 0.5), "only half the merit of a picture"
    assert verdict(small_set, 0, ("stop", 0), ("large", 3)) == ("wrong", True, -1.0)
    assert verdict(small_set, 0, ("stop_low", 0))[0] == "neutral", "excluded from the misleading kind"
    assert verdict(small_set, 0, ("left", 4))[0] == "wrong"
    assert verdict(small_set, 0, ("left", 0))[0] == "neutral", "misleading on another word only"
    assert verdict(small_set, 0) == ("neutral", False, 0.0)


def test_facial_expressions_head_movements_and_rest_poses_of_a_text_are_judged(small_set):
    assert verdict(small_set, 0, ("large", 4), faces=["joy"])[0] == "wrong"
    assert verdict(small_set, 1, heads=["shake"])[0] == "wrong"
    assert verdict(small_set, 1, ("hands_low", 1)) == ("right", False, 1.0), "as without a gesture"
    assert verdict(small_set, 1, ("beat", 1))[0] == "neutral"


def test_gesture_choice_metrics_are_the_worst_over_random_seeds_in_each_half_of_the_utterances(
    small_set, monkeypatch, tmp_path
):
    right, wrong = (judge_utterance(small_set.utterances[k], small_set, shown, set(), set()) for k, shown in
                    ((0, [ShownGesture("large", 4)]), (0, [ShownGesture("stop", 0)])))  # fmt: skip
    plain = judge_utterance(small_set.utterances[1], small_set, [], set(), set())
    runs = [[(small_set.utterances[0], first), (small_set.utterances[1], plain)] for first in (right, wrong, right)]
    monkeypatch.setattr(judged, "judge_seeds", lambda _: runs)
    (tmp_path / "sentences").mkdir()
    for name in ("sentences.tsv", "kinds.tsv"):
        (tmp_path / "sentences" / name).write_text((tmp_path / name).read_text())
    values = {metric.name.removeprefix("meaning.judged_"): metric.value for metric in judged.bench(tmp_path)}
    assert values["odd_wrong"] == 100.0
    assert values["odd_merit"] == -100.0
    assert (values["even_right"], values["even_plain_wrong"]) == (100.0, 0.0)


def test_missing_folder_of_judged_utterances_gives_metrics_without_value(tmp_path):
    for corpus in (None, tmp_path):
        metrics = list(judged.bench(corpus))
        assert {metric.value for metric in metrics} == {None}
        assert all(metric.why for metric in metrics)


@pytest.mark.skipif(not (SENTENCE_FOLDER / "score.py").exists(), reason="needs the scorer of the judged utterances")
def test_verdicts_agree_with_the_scoring_program_of_the_judged_utterances():
    spec = importlib.util.spec_from_file_location("score", SENTENCE_FOLDER / "score.py")
    score = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(score)
    rows, table = score.load(SENTENCE_FOLDER / "sentences.tsv", SENTENCE_FOLDER / "kinds.tsv")
    judged_set = load_judged(SENTENCE_FOLDER)
    lexemes = sorted({name for names in table.values() for name in names})
    for number, utterance in enumerate(judged_set.utterances):
        shown = [_pick(utterance, lexemes, number * 3 + k) for k in range(number % 3)]
        faces, heads = {("joy", "anger", "fear")[number % 3]}, {("nod", "shake", "tilt")[number % 3]}
        gestures = [{"lexeme": item.lexeme, "index": item.token} for item in shown]
        theirs = score.judge(
            rows[utterance.id], table, {"gestures": gestures, "face": sorted(faces), "head": sorted(heads)}
        )
        ours = judge_utterance(utterance, judged_set, shown, faces, heads)
        assert (ours.verdict, ours.has_hit, ours.merit, utterance.needs_picture) == (
            theirs["verdict"], theirs["hit"], theirs["merit"], theirs["calls"],
        )  # fmt: skip


def _pick(utterance: JudgedUtterance, lexemes: list[str], number: int) -> ShownGesture:
    """Return a gesture on a word, both chosen by a number."""
    candidates = sorted(utterance.accepted) if number % 2 and utterance.accepted else lexemes
    return ShownGesture(candidates[number * 7 % len(candidates)], number * 5 % len(utterance.tokens))
