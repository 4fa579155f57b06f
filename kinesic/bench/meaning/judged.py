"""Benchmark of gesture choice on utterances with gestures labelled by judges."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from kinesic.bench.meaning.judging import (
    JudgedSet,
    JudgedUtterance,
    Judgement,
    ShownGesture,
    judge_utterance,
    load_judged,
    read_tokens,
)
from kinesic.bench.metric import Metric
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.expressivity.style.style import Style
from kinesic.intent.author import plan_behaviours
from kinesic.intent.behaviours import ChosenBehaviour
from kinesic.intent.reading.passage import Passage

SEED_COUNT = 10  # number of random seeds for each utterance, of which the worst one counts
FACE_EMOTIONS = {
    "joy": "joy", "smile": "joy", "polite": "joy", "interest": "none", "sadness": "sadness", "sorry": "sadness",
    "despair": "sadness", "disappointment": "sadness", "LOWER_MOUTH_CORNERS": "sadness", "surprise": "surprise",
    "anger": "anger", "hate": "anger", "fear": "fear", "panic": "fear", "worry": "fear", "anxiety": "fear",
    "disgust": "disgust", "contempt": "disgust", "pride": "joy", "relief": "joy",
}  # face lexeme -> emotion that a viewer recognises  # fmt: skip
# Head lexeme -> kind of head movement.
HEAD_KINDS = {"NOD": "nod", "SHAKE": "shake", "ASIDE_LEFT": "tilt", "ASIDE_RIGHT": "tilt", "TILT": "tilt"}
# Reason stated in metrics without a value.
MISSING_SET = "no judged utterances (KINESIC_CORPUS must name a folder with sentences/sentences.tsv)"


@dataclass(frozen=True)
class Goal:
    """Goal of one metric of the benchmark of judged gestures."""

    value: float | None
    better: Literal["lower", "higher"]


METRIC_GOALS = {
    "right": Goal(None, "higher"),
    "neutral": Goal(None, "lower"),
    "wrong": Goal(3.0, "lower"),
    "hits": Goal(65.0, "higher"),
    "merit": Goal(78.0, "higher"),
    "plain_wrong": Goal(3.0, "lower"),
    "trap_wrong": Goal(6.0, "lower"),
    "plain_precision": Goal(None, "higher"),
}  # [%] goals by metric; merit in points
HALF_PARITIES = {"even": False, "odd": True}  # half -> whether its ids are odd; the odd half serves for tuning


def bench(corpus: Path | None) -> Iterator[Metric]:
    """Measure the fit of gestures to judged utterances, for the worst seed.

    Args:
        corpus: folder of the corpora; None: absent.
    """
    folder = corpus / "sentences" if corpus is not None else None
    judged = load_judged(folder) if folder is not None and (folder / "sentences.tsv").exists() else None
    runs = judge_seeds(judged) if judged is not None else ()
    for half, is_odd in HALF_PARITIES.items():
        chosen = [[(utterance, result) for utterance, result in run if utterance.is_odd is is_odd] for run in runs]
        figures = [summarise_verdicts(run) for run in chosen]
        for name, goal in METRIC_GOALS.items():
            worst = max if goal.better == "lower" else min
            value = worst((figure[name] for figure in figures), default=None)
            unit = "points" if name == "merit" else "%"
            target = goal.value if half == "even" else None
            why = "" if judged is not None else MISSING_SET
            yield Metric(f"meaning.judged_{half}_{name}", value, unit, target, goal.better, why=why)


def judge_seeds(judged: JudgedSet, seeds: int = SEED_COUNT) -> Sequence[Sequence[tuple[JudgedUtterance, Judgement]]]:
    """Return the verdicts on every utterance, for each random seed."""
    lexicon, style = Lexicon.load(), Style.load("neutral")
    return [
        [
            (utterance, judge_chosen_behaviours(utterance, judged, lexicon, style, seed))
            for utterance in judged.utterances
        ]
        for seed in range(seeds)
    ]


def judge_chosen_behaviours(
    utterance: JudgedUtterance, judged: JudgedSet, lexicon: Lexicon, style: Style, seed: int
) -> Judgement:
    """Choose an utterance's behaviours, and return the verdict on these behaviours."""
    passage, selection = plan_behaviours(utterance.text, lexicon, style, seed=seed)
    gestures, faces, heads = read_shown(passage, utterance, selection.behaviours)
    return judge_utterance(utterance, judged, gestures, faces, heads)


def read_shown(
    passage: Passage, utterance: JudgedUtterance, behaviours: Iterable[ChosenBehaviour]
) -> tuple[list[ShownGesture], set[str], set[str]]:
    """Return gestures, facial emotions and head movements shown for an utterance.

    Each gesture has the index of its word.
    """
    tokens = _align(passage, utterance.tokens)
    gestures, faces, heads = list[ShownGesture](), set[str](), set[str]()
    for behaviour in behaviours:
        word = _stroke_word(behaviour)
        if behaviour.channel == "gesture" and word >= 0:
            gestures.append(ShownGesture(behaviour.lexeme, tokens[word]))
        elif behaviour.channel == "face":
            faces.add(FACE_EMOTIONS.get(behaviour.lexeme, "none"))
        elif behaviour.channel == "head":
            heads.add(HEAD_KINDS.get(behaviour.lexeme, "none"))
    return gestures, faces, heads


def _stroke_word(behaviour: ChosenBehaviour) -> int:
    """Return the index of a stroke's word, -1 without a word."""
    digits = behaviour.intent.stroke.reference.partition(":w")[2].partition("+")[0].partition("-")[0]
    return int(digits) - 1 if digits.isdigit() else -1


def _align(passage: Passage, tokens: Sequence[str]) -> list[int]:
    """Return the utterance's token index for each word of a passage."""
    indices, at = list[int](), 0
    for word in passage.words:
        plain = "".join(read_tokens(word.plain)) or word.plain
        index = next((k for k in range(at, len(tokens)) if plain in tokens[k].replace("\u2019", "'")), at)
        indices.append(index)
        at = index
    return indices


def summarise_verdicts(results: Sequence[tuple[JudgedUtterance, Judgement]]) -> dict[str, float]:
    """Return the percentage of each verdict and the mean merit [points]."""
    plain = [result for utterance, result in results if "plain" in utterance.tags]
    trap = [result for utterance, result in results if "trap" in utterance.tags]
    calls = [result for utterance, result in results if utterance.needs_picture]
    everything = [result for _, result in results]
    marks = [mark for result in plain for mark in result.gestures]
    return {
        **{
            verdict: _percent(result.verdict == verdict for result in everything)
            for verdict in ("right", "neutral", "wrong")
        },
        "hits": _percent(call.has_hit for call in calls),
        "merit": 100.0 * sum(result.merit for result in everything) / max(len(everything), 1),
        "plain_wrong": _percent(result.verdict == "wrong" for result in plain),
        "trap_wrong": _percent(result.verdict == "wrong" for result in trap),
        "plain_precision": _percent(mark == "right" for mark in marks),
    }


def _percent(flags: Iterable[bool]) -> float:
    listed = list(flags)
    return 100.0 * sum(listed) / max(len(listed), 1)
