"""Gestures that follow from the structure of a sentence: questions, numbers, persons."""

from collections.abc import Collection, Iterator, Sequence
from itertools import pairwise

from kinesic.intent.meaning.context import Context
from kinesic.intent.meaning.cues import PICTURE_INTENT, Cue, CueKind
from kinesic.intent.meaning.matching import Candidate
from kinesic.intent.meaning.rhythm import place_stroke

ASK_CERTAINTY = 0.62  # certainty of the gesture for a question with a question word
MAX_ECHO_WORDS = 3  # [words] length of the longest question whose question word need not come first
YES_NO_CERTAINTY = 0.5  # certainty of the gesture for a question that asks for yes or no
CHOICE_CERTAINTY = 0.62  # certainty of the gesture for a question between two things
COUNT_CERTAINTY = 0.68  # certainty of the gesture that counts things
LISTED_COUNT_BONUS = 0.12  # added certainty if the number announces a list (`there are three`)
SERIES_COUNT_CERTAINTY = 0.82  # certainty of counting gestures for successive numbers (`one, two, three`)
CORRECTION_CERTAINTY = 0.74  # certainty of the gesture that denies a corrected part (`with the knees, not the back`)
MAX_CORRECTION_WORDS = 6  # [words] length of the longest final clause with `not` that gets a denying gesture
PAIR_CERTAINTY = 0.68  # certainty of the gesture for a word that is repeated after `by`
DEGREE_CERTAINTY = 0.6  # certainty of the gesture for two compared degrees (`cheaper, but ... longer`)
DENIAL_CERTAINTY = 0.66  # certainty of the gesture that denies, in sentences without another one
DENIAL_GESTURES = ("no_low", "refuse_sweep")  # gestures that deny a statement
PERSON_CERTAINTY = 0.46  # certainty of a gesture to speaker or listener, in sentences without another one
MIN_PERSON_WORDS = 3  # [words] length of the shortest sentence with a gesture to speaker or listener
MIN_TOPIC_WORDS = 7  # [words] length of the shortest statement that open hands present
TOPIC_CERTAINTY = 0.52  # certainty of open hands that present a statement
TOPIC_GESTURES = ("conduit", "inform_spread", "open_low", "present")  # open hands that present a statement
GRAVE_CLASSES = ("denial", "sad", "stern")  # word classes of statements without open-hand presenting gestures
COUNT_GESTURES = {  # gesture by number word or digit
    "one": "count_one",
    "two": "count_two",
    "three": "count_three",
    "four": "count_four",
    "five": "count_five",
    "1": "count_one",
    "2": "count_two",
    "3": "count_three",
    "4": "count_four",
    "5": "count_five",
}


def find_structures(context: Context, taken: Collection[int]) -> Iterator[Candidate]:
    """Yield candidate gestures for questions and counted things.

    Args:
        context: the text.
        taken: words of cues, which show something else.
    """
    for sentence, indices in enumerate(context.passage.sentences):
        if not indices:
            continue
        if context.passage.kinds[sentence] == "question":
            yield from _find_questions(context, indices, taken)
        yield from _find_counts(context, indices, taken)
        yield from _find_series(context, indices, taken)
        yield from _find_pairs(context, indices, taken)
        if context.passage.kinds[sentence] != "question":
            yield from _find_corrections(context, indices, taken)
            yield from _find_degrees(context, indices, taken)


def _find_questions(context: Context, indices: Sequence[int], taken: Collection[int]) -> Iterator[Candidate]:
    asker = next((k for k in indices if context.language.has("asker", context.plain[k])), -1)
    choice = next((k for k in indices[1:-1] if context.language.has("choice", context.plain[k])), -1)
    if choice >= 0 and not {choice, choice - 1} & set(taken):
        yield _candidate("contrast_left_right", choice, "offers a choice", "question", CHOICE_CERTAINTY)
    is_short = asker >= 0 and len(indices) <= MAX_ECHO_WORDS  # an echo question (`Like what?`)
    if asker >= 0 and asker not in taken and (is_short or context.is_clause_start(asker)):
        yield _candidate("ask_open", asker, "asks", "question", ASK_CERTAINTY)
    elif asker < 0 and any(
        context.language.has("auxiliary", context.plain[k]) for k in indices[:3] if context.is_clause_start(k)
    ):
        content = [k for k in indices if context.passage.words[k].is_content and k not in taken]
        if content:
            yield _candidate("ask_open", content[-1], "asks for yes or no", "question", YES_NO_CERTAINTY)


def _find_counts(context: Context, indices: Sequence[int], taken: Collection[int]) -> Iterator[Candidate]:
    for k in indices[:-1]:
        gesture = COUNT_GESTURES.get(context.plain[k])
        if gesture in (None, "count_one") or k in taken or context.clauses[k] != context.clauses[k + 1]:
            continue
        thing = _counted_thing(context, k, indices)
        before = context.plain[k - 1] if k > indices[0] else ""
        if not thing or context.language.has("not_counting", before) or context.is_number(context.plain[k + 1]):
            continue
        announced = any(context.language.has("announcer", context.plain[j]) for j in range(max(indices[0], k - 3), k))
        yield _candidate(gesture, k, "is a number", "word", COUNT_CERTAINTY + LISTED_COUNT_BONUS * announced)


def _find_series(context: Context, indices: Sequence[int], taken: Collection[int]) -> Iterator[Candidate]:
    """Yield counting gestures for successive numbers (`past one, past two`).

    Numbers of different clauses that are neither followed by a noun count.
    """
    values = list(dict.fromkeys(COUNT_GESTURES.values()))
    bare = [
        (k, values.index(COUNT_GESTURES[context.plain[k]]))
        for k in indices
        if context.plain[k] in COUNT_GESTURES and k not in taken and context.is_clause_end(k)
    ]
    successive = {k for before, after in pairwise(bare) if after[1] == before[1] + 1 for k in (before[0], after[0])}
    for k, value in bare:
        if k in successive:
            yield _candidate(values[value], k, "counts on", "idiom", SERIES_COUNT_CERTAINTY)


def _find_pairs(context: Context, indices: Sequence[int], taken: Collection[int]) -> Iterator[Candidate]:
    """Yield a gesture of repeated placing for `brick by brick`."""
    for k in indices[:-2]:
        is_pair = context.plain[k] == context.plain[k + 2] and context.language.has("pair_joint", context.plain[k + 1])
        if is_pair and context.passage.words[k].is_content and not any(j in taken for j in range(k, k + 3)):
            yield _candidate("one_after_another", k + 2, "goes on by steps", "idiom", PAIR_CERTAINTY)


def _find_corrections(context: Context, indices: Sequence[int], taken: Collection[int]) -> Iterator[Candidate]:
    """Yield a denying gesture on a short final clause with `not`."""
    for k in indices[1:]:
        clause = context.clause_words(k)
        is_last = clause.start == k and clause.stop > indices[-1] and 2 <= len(clause) <= MAX_CORRECTION_WORDS
        if not is_last or k in taken or not context.language.has("corrector", context.plain[k]):
            continue
        if not context.language.has("not_corrected", context.plain[k + 1]):
            yield _candidate("no_low", k, "corrects", "idiom", CORRECTION_CERTAINTY, intent="negation")


def _find_degrees(context: Context, indices: Sequence[int], taken: Collection[int]) -> Iterator[Candidate]:
    """Yield a gesture of contrast on the second of two compared degrees."""
    degrees = [k for k in indices if context.language.has("comparative", context.plain[k])]
    if len(degrees) == 2 and degrees[1] - degrees[0] > 1 and degrees[1] not in taken:
        yield _candidate("contrast_left_right", degrees[1], "is compared", "idiom", DEGREE_CERTAINTY)


def _counted_thing(context: Context, k: int, indices: Sequence[int]) -> bool:
    """Return whether a number counts things (`three ideas`) instead of units."""
    for j in range(k + 1, min(k + 4, indices[-1] + 1)):
        word = context.plain[j]
        if context.language.has("unit", word) or not context.passage.words[j].is_content:
            return False
        if word.endswith("s") and not word.endswith("ss"):
            return True
    return False


def find_denials(context: Context, taken: Collection[int]) -> Iterator[Candidate]:
    """Yield a denying gesture on the first fact that each statement denies.

    Args:
        context: the text.
        taken: words of cues, which show something else.
    """
    for sentence, indices in enumerate(context.passage.sentences):
        denials = [k for k in indices if k not in taken and _denies_fact(context, k)]
        if denials and context.passage.kinds[sentence] != "question" and context.is_talk(denials[0]):
            yield _candidate(DENIAL_GESTURES, denials[0], "denies", "idiom", DENIAL_CERTAINTY, intent="negation")


def _denies_fact(context: Context, k: int) -> bool:
    """Return whether a word denies a fact.

    A prohibition (`don't run`), a denied degree (`not very`), and a comparison that praises (`never better`) do not.
    """
    language, plain = context.language, context.plain
    if not language.has("denial", plain[k]) or language.has("prefix_denial", plain[k]) or not context.is_own_denial(k):
        return False
    after = [plain[j] for j in range(k + 1, context.clause_words(k).stop)]
    is_order = context.is_clause_start(k) and language.has("prohibition", plain[k])
    is_praise = any(language.has("comparative", word) for word in after)
    return bool(after) and not (is_order or is_praise or language.has("not_corrected", after[0]))


def find_persons(context: Context, taken: Collection[int]) -> Iterator[Candidate]:
    """Yield a gesture towards the listener or speaker that a sentence mentions."""
    for indices in context.passage.sentences:
        if len(indices) < MIN_PERSON_WORDS:
            continue
        passage = context.passage  # strokes fall on content words beside the person
        free = [k for k in indices if k not in taken and passage.words[place_stroke(passage, k)].is_content]
        listeners = [k for k in free if context.language.has("listener", context.plain[k])]
        speakers = [k for k in free if context.language.has("pointed_speaker", context.plain[k])]
        if listeners and not context.language.has("no_listener", context.plain[min(listeners[-1] + 1, indices[-1])]):
            yield _candidate("you_low", listeners[-1], "is the listener", "idiom", PERSON_CERTAINTY)
        elif speakers:
            yield _candidate("me_low", speakers[-1], "is the speaker", "idiom", PERSON_CERTAINTY)


def find_topics(context: Context) -> Iterator[Candidate]:
    """Yield a presenting gesture on each long statement's second content word.

    A lively speaker presents statements to the listener, unless they are denied, sad or stern.
    """
    for sentence, indices in enumerate(context.passage.sentences):
        content = [k for k in indices if context.passage.words[k].is_content]
        is_grave = any(context.language.has(name, context.plain[k]) for k in indices for name in GRAVE_CLASSES)
        if context.passage.kinds[sentence] == "statement" and len(indices) >= MIN_TOPIC_WORDS and not is_grave:
            yield from (_candidate(TOPIC_GESTURES, k, "is presented", "idiom", TOPIC_CERTAINTY) for k in content[1:2])


def _candidate(
    gesture: str | tuple[str, ...], k: int, says: str, kind: CueKind, certainty: float, *, intent: str = PICTURE_INTENT
) -> Candidate:
    shows = (gesture,) if isinstance(gesture, str) else gesture
    cue = Cue(says, (), shows, kind, certainty, intent, "any")
    return Candidate(cue, k, k, k)
