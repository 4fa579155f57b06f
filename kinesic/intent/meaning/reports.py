"""Plain reports, in which words are mentioned and not acted out."""

from collections.abc import Sequence

from kinesic.intent.meaning.context import FRAGMENT_LENGTH, OPENING_QUOTES, Context
from kinesic.intent.meaning.matching import Candidate

MIN_MENTIONED_WORDS = 3  # smallest number of other content words in a clause that only mentions an action
MIN_STEM_LETTERS = 3  # letters of the shortest stem of a regular past form
MIN_DETAIL_WORDS = 3  # smallest number of content words, the last a noun, before a place that is a detail


def is_told(context: Context, k: int) -> bool:
    """Return whether the clause of a word plainly reports something.

    Reports of the speaker's past (`I sent it back on Tuesday`) and of things of the speaker (`my brother drives a van`)
    belong to them. Talk to the listener, opinions, present actions and intensified statements do not.

    Args:
        context: the text.
        k: index of the word.
    """
    if not context.is_talk(k):
        return True
    indices, has, plain = context.sentence(k), context.language.has, context.plain
    if context.passage.kinds[context.passage.words[k].sentence] != "statement" or len(indices) <= FRAGMENT_LENGTH:
        return False
    if has("imperative", plain[indices[0]]):
        return False
    if any(has(name, plain[j]) for j in indices for name in ("listener", "talk_marker", "intensifier")):
        return False
    is_own = any(
        has("speaker", plain[j]) and (has("subject", plain[j]) or has("contracted", plain[j])) for j in indices
    )
    return is_past(context, k) or not is_own


def is_past(context: Context, k: int) -> bool:
    """Return whether a word's clause is in the past tense.

    The first finite verb decides. A clause without a verb has the tense of its sentence.
    """
    tense = _find_tense(context, context.clause_words(k))
    return (tense or _find_tense(context, context.sentence(k))) == "past"


def _find_tense(context: Context, indices: Sequence[int]) -> str:
    """Return the tense of the first finite verb.

    It is `past` or `present`, or an empty text if it is unknown.
    """
    has, plain = context.language.has, context.plain
    is_open = False  # whether a verb with equal present and past forms precedes
    for k in indices:
        word = plain[k]
        follows_subject = k > indices[0] and has("subject", plain[k - 1])
        if has("past_auxiliary", word):
            return "past"
        if has("auxiliary", word) or has("contracted", word):
            return "present"
        if _is_noun(context, k) or not context.passage.words[k].is_content:
            continue
        if _is_past_verb(context, k):
            return "past"
        if has("invariant_verb", word):
            is_open = True
        elif follows_subject and not is_open:
            return "present"
    is_dated = any(has("past_time", plain[k]) for k in indices)
    return "past" if is_open and is_dated else ""


def _is_past_verb(context: Context, k: int) -> bool:
    """Return whether a word is a verb in the past form.

    Examples are `walked` and `ran`, but not `feed`.
    """
    word, classes = context.plain[k], context.language.classes
    stems = [word.removesuffix(ending) for ending in classes.get("past_ending", ()) if word.endswith(ending)]
    is_regular = any(len(stem) >= MIN_STEM_LETTERS and stem[-1] != "e" for stem in stems)
    is_past_form = is_regular or context.language.has("past_verb", word)
    return is_past_form and context.passage.words[k].is_content and not _is_noun(context, k)


def _is_noun(context: Context, k: int) -> bool:
    """Return whether a word follows an article or adjective, as nouns do."""
    return k > 0 and any(context.language.has(name, context.plain[k - 1]) for name in ("determiner", "adjective"))


def is_mentioned(context: Context, candidate: Candidate) -> bool:
    """Return whether a report mentions an action or thing among other facts.

    Repeated words, adjectives and actions in progress are acted out anyway.
    """
    clause = context.clause_words(candidate.first)
    inside = range(candidate.first, candidate.last + 1)
    others = [k for k in clause if k not in inside and context.passage.words[k].is_content]
    return len(others) >= MIN_MENTIONED_WORDS and not _is_vivid(context, candidate)


def is_past_deed(context: Context, candidate: Candidate) -> bool:
    """Return whether a candidate is a past-tense verb in a longer report.

    An example is `rang me` in `the doctor rang me about the results on Friday`.
    """
    has_verb = any(_is_past_verb(context, k) for k in range(candidate.first, candidate.last + 1))
    return has_verb and is_told(context, candidate.first) and is_mentioned(context, candidate)


def is_detail(context: Context, candidate: Candidate) -> bool:
    """Return whether a place word only modifies the noun before it.

    An example is `the bank round the corner`.
    """
    before = range(context.clause_words(candidate.first).start, candidate.first)
    facts = [k for k in before if context.passage.words[k].is_content]
    modifies_noun = len(facts) >= MIN_DETAIL_WORDS and facts[-1] == candidate.first - 1 and _is_noun(context, facts[-1])
    return modifies_noun and not _is_vivid(context, candidate)


def is_last_fact(context: Context, candidate: Candidate) -> bool:
    """Return whether a candidate ends its clause or precedes a conjunction."""
    if context.is_clause_end(candidate.last):
        return True
    return context.language.has("conjunction", context.plain[candidate.last + 1])


def is_stressed(context: Context, candidate: Candidate) -> bool:
    """Return whether a candidate is emphasised or repeats a word.

    An example of a repetition is `up and up`.
    """
    inside = range(candidate.first, candidate.last + 1)
    words = [context.plain[k] for k in inside if context.passage.words[k].is_content or k == candidate.stroke]
    is_repeated = any(context.plain[candidate.first : candidate.last + 1].count(word) > 1 for word in words)
    return is_repeated or any(context.passage.words[k].emphatic for k in inside)


def _is_vivid(context: Context, candidate: Candidate) -> bool:
    """Return whether a candidate is stressed, a quality or an ongoing action."""
    inside = range(candidate.first, candidate.last + 1)
    is_acted = is_stressed(context, candidate) or any(_is_in_progress(context, k) for k in inside)
    return is_acted or _is_quality(context, candidate)


def _is_quality(context: Context, candidate: Candidate) -> bool:
    """Return whether a candidate is an adjective (`as tall as`).

    In `the bank round the corner`, `round` is a preposition.
    """
    has, plain, words, stroke = context.language.has, context.plain, context.passage.words, candidate.stroke
    if candidate.first > 0 and any(has(name, plain[candidate.first - 1]) for name in ("degree", "copula")):
        return True
    is_before_noun = stroke + 1 < len(words) and words[stroke + 1].is_content
    follows_noun = stroke > 0 and words[stroke - 1].is_content
    return has("adjective", plain[stroke]) and (is_before_noun or not follows_noun)


def _is_in_progress(context: Context, k: int) -> bool:
    """Return whether a word is a progressive verb.

    An example is `was running`, but not the noun in `the driving`.
    """
    return not _is_noun(context, k) and context.plain[k].endswith(
        tuple(context.language.classes.get("progressive_ending", ()))
    )


def is_name(context: Context, candidate: Candidate) -> bool:
    """Return whether a candidate's word is a proper name.

    A capital within a sentence marks a name.
    """
    word = context.passage.words[candidate.stroke]
    begins = candidate.stroke == context.sentence(candidate.stroke)[0] or any(
        sign in word.before for sign in OPENING_QUOTES
    )
    return (
        word.is_content
        and not begins
        and not word.emphatic
        and word.text[:1].isupper()
        and not word.text[1:2].isupper()
    )
