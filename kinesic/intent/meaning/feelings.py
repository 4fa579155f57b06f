"""Conditions under which faces and head movements of rules are shown."""

from collections.abc import Collection
from dataclasses import replace

from kinesic.intent.intents import Intent
from kinesic.intent.meaning.context import Context

HEAD_CHANNEL = frozenset({"head"})  # channel of head movements
GRAVE_REACH = 12  # [words] distance from a word within which denials, sad and stern words count
MIN_RHYTHM_WORDS = 16  # [words] shortest text in which viewers take accent nods as rhythm, not assent
NOD_PREFIXES = ("accent", "noun", "first-noun", "emphasis")  # prefixes of intents that cause a small nod
STRUCTURE_PREFIXES = (
    "turn",
    "boundary",
    "accent",
    "emphasis",
    "noun",
    "first",
    "listing",
    "compound",
    "deictic",
    "world",
)  # prefixes of intents about the text's structure, without an attitude
SOCIAL_PREFIX = "performative"  # prefix of intents that address the listener
GREETING_INTENT = "performative-greet"  # intent of greetings, which begin a clause
EMOTION_PREFIX = "emotion"  # prefix of intents that show the emotion of a person
JUDGEMENT_INTENTS = frozenset({"positive", "negative"})  # intents of judgements, shown by a small smile or a sad mouth
ASKING_INTENTS = frozenset({"question", "rhetorical"})  # question intents whose words also begin clauses of statements
NOD_INTENTS = frozenset({"affirmation", "intensification", "obligation", "assumption"})  # intents shown by a nod
FORMAL_INTENTS = frozenset(
    {"inclusivity", "interjection", "possibility"}
)  # intents whose head movements mislead more than they help


def temper(context: Context, intent: Intent, idioms: Collection[int], harmless: Collection[int]) -> Intent | None:
    """Mute or drop an intent whose face and head signals mislead.

    Idioms say something else than their words. A feeling is shown only by the speaker who has it, not in a question, a
    wish, a denial or a report. The head does not nod where something is denied, sad or stern.

    Args:
        context: the text.
        intent: of a rule.
        idioms: words of idioms.
        harmless: words of idioms that deny nothing.

    Returns:
        The intent, without its nod where a nod misleads; None if it is dropped.
    """
    if "emoticon" in intent.reason:
        return intent
    if intent.name.startswith(NOD_PREFIXES) and _is_misread_nod(context, intent.word):
        return replace(intent, muted=intent.muted | HEAD_CHANNEL)
    if intent.name in ASKING_INTENTS and not context.is_question(intent.word):
        return None
    if intent.name.startswith(STRUCTURE_PREFIXES) or _holds(context, intent, idioms, harmless):
        return intent
    return None


def _holds(context: Context, intent: Intent, idioms: Collection[int], harmless: Collection[int]) -> bool:
    at = intent.word
    if intent.name == "negation" and not context.is_own_denial(_first_word(intent)):
        return False
    if (at in idioms and _first_word(intent) in idioms) or intent.name in FORMAL_INTENTS:
        return False
    if intent.name.startswith(SOCIAL_PREFIX):
        is_told = context.is_reported(at) or context.is_others(at)
        return not is_told and (intent.name != GREETING_INTENT or context.is_clause_start(_first_word(intent)))
    if intent.name.startswith(EMOTION_PREFIX):
        return context.is_felt(at) and not _is_unreal(context, at, harmless)
    if intent.name in JUDGEMENT_INTENTS:
        return context.is_talk(at) and not _is_unreal(context, at, harmless) and not _is_grave(context, at)
    if intent.name in NOD_INTENTS:
        is_agreed = not context.is_question(at) and context.is_talk(at)
        return not _is_grave(context, at) and (intent.name != "affirmation" or is_agreed)
    return True


def _is_unreal(context: Context, at: int, harmless: Collection[int]) -> bool:
    is_spoken_of = context.is_question(at) or context.is_wished(at) or context.is_reported(at)
    return is_spoken_of or context.is_negated(at, harmless)


def _is_grave(context: Context, k: int) -> bool:
    """Return whether a nearby word denies something, or is sad or stern."""
    near = range(max(0, k - GRAVE_REACH), min(len(context.plain), k + GRAVE_REACH + 1))
    return any(context.language.has(name, context.plain[j]) for j in near for name in ("denial", "sad", "stern"))


def _is_misread_nod(context: Context, k: int) -> bool:
    """Return whether viewers may mistake a nod on an accent for assent."""
    is_short = len(context.plain) < MIN_RHYTHM_WORDS
    return is_short or _is_grave(context, k) or context.is_reported(k)


def _first_word(intent: Intent) -> int:
    digits = intent.start.reference.partition(":w")[2].partition("+")[0]
    return int(digits) - 1 if digits.isdigit() else intent.word
