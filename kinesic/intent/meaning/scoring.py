"""Scores of candidate gestures, and the choice of those to perform."""

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass

from kinesic.intent.meaning.context import Context
from kinesic.intent.meaning.cues import PICTURE_INTENT
from kinesic.intent.meaning.matching import Candidate
from kinesic.intent.meaning.reports import (
    is_detail,
    is_last_fact,
    is_mentioned,
    is_name,
    is_past_deed,
    is_stressed,
    is_told,
)

MIN_SECOND_LIVELINESS = 0.5  # liveliness from which a clause may have a second illustrating gesture
MIN_WORD_DISTANCE = 3  # [words] smallest distance of two illustrating gestures


@dataclass(frozen=True)
class Penalties:
    """Score penalties for unsuitable contexts of a candidate gesture."""

    negated: float = 0.4  # denied literal word or feeling
    asked_word: float = 0.1  # literal word in a question that is no request
    asked_feeling: float = 0.5  # feeling in a question
    wished: float = 0.4  # feeling in a wish
    wished_word: float = 0.05  # literal word in a wish
    reported: float = 0.3  # feeling or emblem in a report
    not_felt: float = 0.45  # feeling of somebody else
    plain_emblem: float = 0.12  # emblem, emotion or listener in a plain report
    plain_word: float = 0.12  # pointing, metaphor or drawn shape in a plain report
    mentioned: float = 0.15  # action, thing or place that a plain report mentions among other facts, in addition
    name: float = 0.3  # word that is a proper name
    asked_emblem: float = 0.15  # emblem or feeling in a question
    told_idiom: float = 0.15  # idiom with an emblem or feeling in a report
    quoted_idiom: float = 0.15  # idiom with an emblem or feeling in a quotation, in addition
    denied_idiom: float = 0.35  # idiom with an emblem or feeling in the scope of a denial
    asked_idiom: float = 0.35  # idiom with an emblem or feeling within a question about facts
    others_idiom: float = 0.3  # idiom with a face, as a greeting has, in a sentence about a third person
    others_listener: float = 0.3  # gesture to the listener in a sentence about a third person
    grave_praise: float = 0.3  # praise, joy or pride in a sentence about something sad or bad
    ironic_praise: float = 0.3  # praise after `oh`, or of something that happens again
    final_time: float = 0.12  # time after the verb of a plain report (`he came yesterday`), unlike `yesterday he came`
    emphasis: float = -0.1  # word that the writer stresses


DEFAULT_PENALTIES = Penalties()  # default score penalties for unsuitable contexts
# Smallest scores by gesture category: a wrong emblem misleads, a wrong open hand hardly does.
CATEGORY_THRESHOLDS: Mapping[str, float] = {
    "emblem": 0.62,
    "emotion": 0.64,
    "deictic": 0.52,
    "iconic": 0.56,
    "metaphoric": 0.52,
    "adaptor": 0.58,
    "beat": 0.3,
    "rest": 0.7,
}
GESTURE_THRESHOLDS: Mapping[str, float] = {  # smallest scores by gesture, where they differ from those of the category
    **dict.fromkeys(("open_low", "offer", "you_low", "me_low", "ask_open", "here_low", "present"), 0.42),
    **dict.fromkeys(("left", "right", "crossed_out", "cut_off", "thumb_down", "no_wag", "refuse_push"), 0.68),
    **dict.fromkeys(("gotcha", "watching_you", "shake_fist", "go_away", "contempt", "crazy"), 0.7),
}
UNKNOWN_THRESHOLD = 0.6  # smallest score of a gesture of an unknown category
SENSITIVE_CATEGORIES = frozenset({"emblem", "emotion"})  # categories scored lower in reported speech and questions
REPORT_CATEGORIES = frozenset(
    {"deictic", "metaphoric", "iconic", "adaptor"}
)  # gesture categories that plain reports rarely need
ACTED_CATEGORIES = frozenset({"iconic", "adaptor"})  # gesture categories that act out an action or draw a thing
GRAVE_CLASSES = ("sad", "stern")  # classes of words whose presence in a sentence makes praise or joy unlikely
SENSITIVE_INTENTS = ("emotion", "performative")  # prefixes of intents penalised in reports and questions
# Prefixes of intents of praise, agreement, joy and pride.
GLAD_INTENTS = ("performative-praise", "performative-agree", "emotion-joy", "emotion-pride")
SHRUG_GESTURES = frozenset({"doubt_shrug", "shrug_small"})  # gestures of uncertainty, which fit a question
# Further gestures penalised in reports and questions.
SENSITIVE_GESTURES = SHRUG_GESTURES | {"you", "you_all", "left", "right", "we", "between_us"}
# Gestures for a time, which frames a report at its start, but is a detail at its end.
TIME_GESTURES = frozenset(
    {"time_span", "past_over_shoulder", "future_forward", "now_here", "before_that", "after_that"}
)
LISTENER_GESTURES = frozenset({"you", "you_low", "you_all", "gotcha", "watching_you"})  # gestures towards the listener


@dataclass(frozen=True, eq=False)
class Picture:
    """Candidate gesture with its score, 0..1."""

    candidate: Candidate
    score: float


def score(
    context: Context,
    candidate: Candidate,
    idioms: Collection[int],
    categories: Mapping[str, str],
    liveliness: float = 0.0,
) -> float:
    """Return the score of a candidate gesture, 0..1.

    Args:
        context: the text.
        candidate: words with gestures.
        idioms: words of idioms that deny nothing.
        categories: of all gestures.
        liveliness: 0..1 of the style.
    """
    cue, at = candidate.cue, candidate.first
    is_literal = cue.kind in ("word", "feeling")
    is_sensitive = cue.intent.startswith(SENSITIVE_INTENTS) or any(
        categories.get(shown, "") in SENSITIVE_CATEGORIES or shown in SENSITIVE_GESTURES for shown in cue.shows
    )
    value = cue.certainty
    if any(context.passage.words[k].emphatic for k in range(candidate.first, candidate.last + 1)):
        value -= DEFAULT_PENALTIES.emphasis
    if cue.intent.startswith(GLAD_INTENTS):
        value -= DEFAULT_PENALTIES.grave_praise * _is_about_grave(context, candidate)
        value -= DEFAULT_PENALTIES.ironic_praise * _sounds_ironic(context, candidate)
    if not LISTENER_GESTURES.isdisjoint(cue.shows):
        value -= DEFAULT_PENALTIES.others_listener * context.is_others(at)
    if TIME_GESTURES.issuperset(cue.shows) and is_told(context, at):
        value -= DEFAULT_PENALTIES.final_time * is_last_fact(context, candidate) * (cue.kind == "idiom")
    if is_literal and context.is_negated(at, idioms):
        value -= DEFAULT_PENALTIES.negated
    if cue.kind == "feeling":
        value -= DEFAULT_PENALTIES.asked_feeling * context.is_question(at)
        value -= DEFAULT_PENALTIES.wished * context.is_wished(at)
        value -= DEFAULT_PENALTIES.not_felt * (not context.is_felt(at))
        value -= DEFAULT_PENALTIES.reported * (not is_sensitive and context.is_reported(at))
    elif cue.kind == "word":
        value -= DEFAULT_PENALTIES.asked_word * (context.is_question(at) and not context.is_request(at))
        value -= DEFAULT_PENALTIES.wished_word * context.is_wished(at)
    if cue.kind == "word":
        value -= _penalise_report(context, candidate, categories) * (1.0 - liveliness) * (not is_sensitive)
        value -= DEFAULT_PENALTIES.name * is_name(context, candidate)
    if is_sensitive and cue.kind != "question":
        value -= DEFAULT_PENALTIES.reported * (is_literal and context.is_reported(at))
        value -= DEFAULT_PENALTIES.plain_emblem * _is_plain(context, candidate)
        value -= DEFAULT_PENALTIES.asked_emblem * (
            cue.kind == "idiom"
            and cue.where == "any"
            and context.is_question(at)
            and SHRUG_GESTURES.isdisjoint(cue.shows)
        )
        if cue.kind == "idiom":
            value -= DEFAULT_PENALTIES.mentioned * is_past_deed(context, candidate)
            value -= DEFAULT_PENALTIES.told_idiom * context.is_reported(at)
            value -= DEFAULT_PENALTIES.quoted_idiom * context.is_quoted(at)
            value -= DEFAULT_PENALTIES.denied_idiom * context.is_negated(at, idioms)
            value -= DEFAULT_PENALTIES.asked_idiom * context.is_asked_within(at)
            value -= DEFAULT_PENALTIES.others_idiom * (cue.intent != PICTURE_INTENT and context.is_others(at))
    return min(max(value, 0.0), 1.0)


def _is_plain(context: Context, candidate: Candidate) -> bool:
    """Return whether a candidate's clause is a plain report.

    An idiom with a picture (`our class`) is also plain among reports of the speaker's own past and things.
    """
    cue, at = candidate.cue, candidate.first
    is_picture = cue.kind == "idiom" and cue.intent == PICTURE_INTENT
    return is_told(context, at) if is_picture else not context.is_talk(at)


def _penalise_report(context: Context, candidate: Candidate, categories: Mapping[str, str]) -> float:
    """Return the penalty of a gesture for a plain or reported word."""
    shown = {categories.get(each, "") for each in candidate.cue.shows}
    if shown.isdisjoint(REPORT_CATEGORIES):
        return 0.0
    is_plain = not (context.is_talk(candidate.first) or is_stressed(context, candidate))
    value = DEFAULT_PENALTIES.plain_word * is_plain
    if is_told(context, candidate.first):
        is_acted = not shown.isdisjoint(ACTED_CATEGORIES)
        value += DEFAULT_PENALTIES.mentioned * (is_mentioned if is_acted else is_detail)(context, candidate)
    return value


def _is_about_grave(context: Context, candidate: Candidate) -> bool:
    """Return whether other words of a candidate's sentence are sad or stern."""
    outside = (k for k in context.sentence(candidate.first) if not candidate.first <= k <= candidate.last)
    return any(context.language.has(name, context.plain[k]) for k in outside for name in GRAVE_CLASSES)


def _sounds_ironic(context: Context, candidate: Candidate) -> bool:
    """Return whether praise follows `oh`, or its sentence has `again` or `another`."""
    indices = context.sentence(candidate.first)
    before = context.plain[candidate.first - 1] if candidate.first > indices[0] else ""
    outside = (k for k in indices if not candidate.first <= k <= candidate.last)
    return context.language.has("exclaimer", before) or any(
        context.language.has("repetition", context.plain[k]) for k in outside
    )


def choose_pictures(
    context: Context,
    candidates: Iterable[Candidate],
    idioms: Collection[int],
    categories: Mapping[str, str],
    liveliness: float = 0.0,
) -> list[Picture]:
    """Choose the candidate gestures to perform, at most one per clause.

    A lively speaker may have several in a clause, at least `MIN_WORD_DISTANCE` words apart.
    """
    scored = [
        Picture(candidate, score(context, candidate, idioms, categories, liveliness))
        for candidate in candidates
        if candidate.cue.shows
    ]
    ranked = sorted(
        (entry for entry in scored if entry.score >= threshold(entry.candidate.cue.shows, categories)),
        key=lambda each: (-each.score, each.candidate.first),
    )
    kept, clauses, near = list[Picture](), set[int](), set[int]()
    for picture in ranked:
        stroke = picture.candidate.stroke
        is_free = context.clauses[stroke] not in clauses or liveliness >= MIN_SECOND_LIVELINESS
        if is_free and stroke not in near:
            kept.append(picture)
            clauses.add(context.clauses[stroke])
            near.update(range(stroke - MIN_WORD_DISTANCE + 1, stroke + MIN_WORD_DISTANCE))
    return sorted(kept, key=lambda each: each.candidate.stroke)


def threshold(shows: Sequence[str], categories: Mapping[str, str]) -> float:
    """Return the largest score threshold of a cue's gestures."""
    return max(
        GESTURE_THRESHOLDS.get(shown, CATEGORY_THRESHOLDS.get(categories.get(shown, ""), UNKNOWN_THRESHOLD))
        for shown in shows
    )
