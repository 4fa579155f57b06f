"""Utterances labelled by judges, and verdicts on chosen behaviours."""

import csv
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

Verdict = Literal["right", "neutral", "wrong"]

MAX_WORD_DISTANCE = 1  # [words] largest distance of a stroke from its word that counts as on the word
BEAT_KIND = "any beat"  # name of the gesture kind that contains all beats
REST_KIND = "any rest"  # name of the gesture kind of rest poses, which do not count as gestures


@dataclass(frozen=True, eq=False)
class JudgedUtterance:
    """Test sentence with the behaviours that judges accept or find misleading."""

    id: str
    text: str
    tokens: tuple[str, ...]
    accepted: Mapping[str, frozenset[int]]  # gesture -> indices of its words
    misleading: tuple[tuple[frozenset[str], frozenset[int] | None], ...]  # gestures, and their words; None: anywhere
    misleading_faces: frozenset[str]
    misleading_heads: frozenset[str]
    accepts_beat: bool
    accepts_nothing: bool
    tags: frozenset[str]

    @property
    def is_odd(self) -> bool:
        """Whether the utterance has an odd number, and so serves for tuning."""
        return int(self.id.lstrip("s")) % 2 == 1

    @property
    def needs_picture(self) -> bool:
        """Whether the utterance calls for a gesture with a meaning."""
        return bool(self.accepted) and not self.accepts_nothing


@dataclass(frozen=True)
class ShownGesture:
    """Gesture chosen for an utterance, and the word of its stroke."""

    lexeme: str
    token: int  # index of the word


@dataclass(frozen=True)
class Judgement:
    """Verdict on the behaviours of one utterance."""

    verdict: Verdict
    has_hit: bool  # whether an accepted gesture is on its word
    merit: float  # -1..1
    gestures: tuple[Verdict, ...]  # verdict on each gesture


@dataclass(frozen=True, eq=False)
class JudgedSet:
    """Judged utterances, and the gestures of each kind."""

    utterances: tuple[JudgedUtterance, ...]
    kinds: Mapping[str, frozenset[str]]


def read_tokens(text: str) -> tuple[str, ...]:
    """Return the words of a text in lower case, without outer punctuation."""
    bare = (re.sub(r"^[^\w]+|[^\w]+$", "", word).lower() for word in text.split())
    return tuple(word for word in bare if word)


def load_judged(folder: Path) -> JudgedSet:
    """Read judged utterances from `sentences.tsv` and gesture kinds from `kinds.tsv`."""
    kinds = {row["kind"]: frozenset(row["ids"].split()) for row in _rows(folder / "kinds.tsv")}
    return JudgedSet(tuple(_read_utterance(row, kinds) for row in _rows(folder / "sentences.tsv")), kinds)


def _rows(path: Path) -> list[dict[str, str]]:
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file, delimiter="\t", quoting=csv.QUOTE_NONE))


def _read_utterance(row: Mapping[str, str], kinds: Mapping[str, frozenset[str]]) -> JudgedUtterance:
    tokens = read_tokens(row["text"])
    accepted: dict[str, frozenset[int]] = {}
    for name, word in _split_items(row["accepted"]):
        indices = _find_word(word, tokens) if word not in ("", "*") else range(len(tokens))
        accepted[name] = accepted.get(name, frozenset()) | frozenset(indices)
    misleading = list[tuple[frozenset[str], frozenset[int] | None]]()
    faces, heads = set[str](), set[str]()
    for name, word in _split_items(row["misleading"]):
        if name.startswith("face:"):
            faces.add(name[5:])
        elif name.startswith("head:"):
            heads.add(name[5:])
        else:
            kind, _, excluded = name.partition(" except ")
            gestures = (kinds[kind] if kind.startswith("any ") else frozenset([kind])) - set(excluded.split())
            misleading.append((gestures, frozenset(_find_word(word, tokens)) if word else None))
    return JudgedUtterance(
        id=row["id"],
        text=row["text"],
        tokens=tokens,
        accepted=accepted,
        misleading=tuple(misleading),
        misleading_faces=frozenset(faces),
        misleading_heads=frozenset(heads),
        accepts_beat=row["beat_ok"] == "1",
        accepts_nothing=row["none_ok"] == "1",
        tags=frozenset(tag.strip() for tag in row["tags"].split(",")),
    )


def _split_items(cell: str) -> Iterator[tuple[str, str]]:
    """Yield gesture names and words of a table cell (`name@word, name`)."""
    for item in (part.strip() for part in cell.split(",")):
        if item:
            name, _, word = item.partition("@")
            yield name, word


def _find_word(word: str, tokens: Sequence[str]) -> list[int]:
    """Return the indices of a word, or of its numbered occurrence (`word#2`)."""
    bare, _, number = word.lower().partition("#")
    positions = list[int]()
    for part in read_tokens(bare):
        places = [k for k, token in enumerate(tokens) if token == part]
        places = places or [k for k, token in enumerate(tokens) if part in re.split(r"[-'\u2019]", token)]
        if number.isdigit() and 0 < int(number) <= len(places):
            places = [places[int(number) - 1]]
        positions += places
    return positions


def judge_utterance(
    utterance: JudgedUtterance, judged: JudgedSet, gestures: Iterable[ShownGesture], faces: set[str], heads: set[str]
) -> Judgement:
    """Judge all behaviours of one utterance.

    Args:
        utterance: text with its labels.
        judged: set that contains it.
        gestures: shown hand gestures.
        faces: shown emotions.
        heads: shown kinds of head movements.
    """
    marks = [(gesture, _judge_gesture(utterance, judged, gesture)) for gesture in gestures]
    marks = [(gesture, mark) for gesture, mark in marks if mark is not None]
    has_hit = any(_is_accepted(utterance, gesture) for gesture, _ in marks)
    verdicts = tuple(mark for _, mark in marks if mark is not None)
    is_wrong = "wrong" in verdicts or bool(faces & utterance.misleading_faces or heads & utterance.misleading_heads)
    if is_wrong:
        return Judgement("wrong", has_hit, -1.0, verdicts)
    if "right" in verdicts or (not marks and utterance.accepts_nothing):
        return Judgement("right", has_hit, 1.0 if has_hit or utterance.accepts_nothing else 0.5, verdicts)
    return Judgement("neutral", has_hit, 0.0, verdicts)


def _is_accepted(utterance: JudgedUtterance, gesture: ShownGesture) -> bool:
    places = utterance.accepted.get(gesture.lexeme, frozenset())
    return _is_near(gesture.token, places)


def _is_near(token: int, places: frozenset[int]) -> bool:
    return any(abs(token - place) <= MAX_WORD_DISTANCE for place in places)


def _judge_gesture(utterance: JudgedUtterance, judged: JudgedSet, gesture: ShownGesture) -> Verdict | None:
    """Return the verdict on one gesture, None for an unlabelled rest pose."""
    if _is_accepted(utterance, gesture):
        return "right"
    here = [lexemes for lexemes, places in utterance.misleading if places and _is_near(gesture.token, places)]
    anywhere = [lexemes for lexemes, places in utterance.misleading if places is None]
    if any(gesture.lexeme in lexemes for lexemes in here):
        return "wrong"
    if gesture.lexeme in utterance.accepted:
        return "neutral"
    if any(gesture.lexeme in lexemes for lexemes in anywhere):
        return "wrong"
    if gesture.lexeme in judged.kinds[BEAT_KIND]:
        return "right" if utterance.accepts_beat else "neutral"
    return None if gesture.lexeme in judged.kinds[REST_KIND] else "neutral"
