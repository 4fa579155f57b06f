"""Choice of compatible behaviours for intents, within a budget."""

import random
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace

from kinesic.intent.behaviour_sets import NO_SIGNAL, BehaviourSet, BehaviourSets, Channel, Choice, Signal
from kinesic.intent.behaviours import NO_EARLIER_BEHAVIOURS, ChosenBehaviour, Earlier, Omission, Selection
from kinesic.intent.budget import MovementBudget
from kinesic.intent.greta.agent import Agent
from kinesic.intent.intents import Intent
from kinesic.intent.kept_intents import KeptIntents
from kinesic.intent.pacing.accents import RHYTHM_INTENT
from kinesic.intent.pacing.candidates import Candidate
from kinesic.intent.pacing.long_strokes import is_in_long_stroke
from kinesic.intent.pacing.memory import NO_MEMORY, ChoiceMemory, PastGesture
from kinesic.intent.pacing.rhythm import BEAT_INTENTS, is_beat, place_beats
from kinesic.intent.pacing.spacing import select_spaced
from kinesic.intent.pacing.tempo import limit_beats
from kinesic.intent.pacing.variety import GestureUses, LexemeSampler
from kinesic.intent.sequences import draw_sequence

CORE_BONUS = 0.05  # bonus on the certainty of an intent's core signals
HAND_LEAD_TIME = 0.4  # [s] time before the first word at which a hand may set out
NEGATION_INTENTS = frozenset({"negation", "negative"})  # intents during which the head does not nod


def choose_behaviours(
    intents: Sequence[Intent],
    sets: BehaviourSets,
    budget: MovementBudget,
    *,
    seed: int = 0,
    agent: Agent | None = None,
    since: float = 0.0,
    earlier: Earlier = NO_EARLIER_BEHAVIOURS,
    memory: ChoiceMemory = NO_MEMORY,
    reachable: Callable[[Intent], Intent] = lambda intent: intent,
) -> Selection:
    """Choose compatible behaviours for all intents within a budget.

    The same intents, sets, budget, memory and seed give the same behaviours. The most certain are chosen first. Each
    channel has its own smallest spacing. There are no more gestures than the budget allows. Within the budget's
    repeat window they differ. The head does not nod within a negation.
    With a tempo, beats on accents fill the time between the other gestures.

    Args:
        intents: of one block.
        sets: behaviours that may show them.
        budget: limits on gestures and spacing.
        seed: of the random choice.
        agent: with preferences and expressivity; None: neutral.
        since: intents with earlier strokes are shown already; their negations still prevent nods [s].
        earlier: behaviours that show them. The budget covers those that may still be replaced and the chosen ones.
        memory: gestures of earlier texts, which are not repeated for a while.
        reachable: moves the stroke of a gesture's intent to a time that the hand can reach.
    """
    agent = agent or Agent()
    generator = random.Random(seed + memory.parts)
    omitted: list[Omission] = []
    candidates_by_channel: dict[Channel, list[Candidate]] = {
        "gesture": [],
        "head": [],
        "face": [],
        "gaze": [],
        "torso": [],
    }
    for intent in (later for later in intents if later.stroke.seconds >= since):
        behaviour_set = sets.find(intent.name)
        if behaviour_set is None:
            omitted.append(Omission(intent, None, f"intent {intent.name} has no behaviour set"))
            continue
        candidates = list(_list_candidates(intent, behaviour_set, agent, generator))
        for candidate in candidates:
            is_gesture = candidate.signal.channel == "gesture"
            candidates_by_channel[candidate.signal.channel].append(
                replace(candidate, intent=reachable(candidate.intent)) if is_gesture else candidate
            )
        if not candidates and not intent.muted:
            omitted.append(Omission(intent, None, f"the set of {intent.name} is empty"))
    negations = KeptIntents(intent for intent in intents if intent.name in NEGATION_INTENTS)
    chosen, replaced = list[ChosenBehaviour](), list[ChosenBehaviour]()
    for channel, channel_candidates in candidates_by_channel.items():
        beats, others = _divide(channel_candidates, budget)
        fixed = [behaviour for behaviour in earlier.fixed if behaviour.channel == channel]
        shown = KeptIntents(behaviour.intent for behaviour in fixed)
        free = [_make_candidate(behaviour) for behaviour in earlier.free if behaviour.channel == channel]
        limits = replace(budget, gestures=budget.pictures) if budget.tempo else budget
        kept = select_spaced([*free, *others], channel, negations, shown, limits, omitted)
        replaced += [candidate.earlier for candidate in free if candidate.earlier is not None and candidate not in kept]
        uses, offset = _recall(memory.forget(replaced), fixed, budget, since), memory.seconds - since
        forms = _beat_forms(sets)
        sampler = LexemeSampler(
            channel,
            agent,
            generator,
            omitted,
            uses,
            offset,
            forms,
            budget.beat_manner,
            budget.preferences,
            budget.slowness,
        )
        past = [time - offset for time in memory.times if time - offset < since]
        times = [since - HAND_LEAD_TIME, *past, *(behaviour.intent.stroke.seconds for behaviour in fixed)]
        drawn = list(sampler.draw(kept, others=times))
        if budget.tempo and beats:
            strokes = [*fixed, *(item.earlier for item in kept if item.earlier), *drawn]
            drawings = [(stroke.lexeme, stroke.intent.stroke.seconds) for stroke in strokes]
            beats = [beat for beat in beats if not is_in_long_stroke(beat.intent.stroke.seconds, drawings)]
            pictures = sum(not is_beat(stroke.lexeme) for stroke in strokes if stroke.intent.stroke.seconds >= since)
            duration = max((beat.intent.stroke.seconds for beat in beats), default=since) - since
            placed = place_beats(
                beats,
                [*past, *(stroke.intent.stroke.seconds for stroke in strokes)],
                limit_beats(budget.tempo, earlier.pictures + pictures, earlier.seconds + duration),
                since=since,
                earlier_strokes=earlier.strokes,
                earlier_seconds=earlier.seconds,
            )
            drawn += sampler.draw(placed, others=[*times, *(stroke.intent.stroke.seconds for stroke in strokes)])
        elif channel == "gesture":
            drawn = _drop_covered_beats(drawn)
        chosen += drawn
    chosen.sort(key=lambda behaviour: (behaviour.intent.stroke.seconds, behaviour.channel))
    return Selection(tuple(chosen), tuple(omitted), tuple(replaced))


def _drop_covered_beats(drawn: Sequence[ChosenBehaviour]) -> list[ChosenBehaviour]:
    """Drop beats between start and stroke of a long gesture."""
    drawings = [(each.lexeme, each.intent.stroke.seconds) for each in drawn if not is_beat(each.lexeme)]
    return [
        each for each in drawn if not (is_beat(each.lexeme) and is_in_long_stroke(each.intent.stroke.seconds, drawings))
    ]


def _divide(candidates: Sequence[Candidate], budget: MovementBudget) -> tuple[list[Candidate], list[Candidate]]:
    """Divide candidates into beats that follow the tempo, and all others.

    Without a tempo, the main accents compete with the others and there are no further beats.
    """
    if budget.tempo is None:
        return [], [candidate for candidate in candidates if candidate.intent.name != RHYTHM_INTENT]
    beats = [
        candidate
        for candidate in candidates
        if candidate.intent.name in BEAT_INTENTS and candidate.signal.channel == "gesture"
    ]
    others = [
        candidate
        for candidate in candidates
        if candidate.intent.name not in BEAT_INTENTS or candidate.signal.channel != "gesture"
    ]
    return beats, others


def _beat_forms(sets: BehaviourSets) -> Sequence[Choice]:
    """Return all gestures that may be chosen as beats."""
    behaviour_set = sets.find(RHYTHM_INTENT)
    return [choice for signal in behaviour_set.signals for choice in signal.choices] if behaviour_set else []


def _recall(
    memory: ChoiceMemory, fixed: Sequence[ChosenBehaviour], budget: MovementBudget, since: float
) -> GestureUses:
    """Collect stroke times of gestures shown in earlier texts and this text."""
    uses = GestureUses(budget.repeat_window)
    for past in memory.gestures:
        uses.add(past)
    for behaviour in fixed:
        at = memory.seconds + behaviour.intent.stroke.seconds - since
        uses.add(PastGesture(behaviour.form, at, behaviour.intent.reason))
    return uses


def _make_candidate(behaviour: ChosenBehaviour) -> Candidate:
    """Convert an earlier behaviour to a candidate preferred over equally certain candidates."""
    choices = (Choice(behaviour.lexeme, 1.0),)
    signal = Signal(behaviour.channel, behaviour.channel, choices)
    return Candidate(behaviour.intent, signal, behaviour.intent.certainty + CORE_BONUS, choices, earlier=behaviour)


def _list_candidates(
    intent: Intent, behaviour_set: BehaviourSet, agent: Agent, generator: random.Random
) -> Iterable[Candidate]:
    """Yield the candidate signals of an intent's behaviour set.

    They are the core, signals that it implies, and random ones.
    """
    if any(signal.spell for signal in behaviour_set.signals):
        timed_signals = list(draw_sequence(intent, behaviour_set, generator))
    else:
        timed_signals = [(intent, signal) for signal in _draw_signals(intent, behaviour_set, agent, generator)]
    for part, signal in timed_signals:
        choices = tuple(choice for choice in signal.choices if choice.lexeme.lower() != NO_SIGNAL)
        if choices and signal.channel not in part.muted:
            weight = intent.certainty * agent.weight(intent.name, signal.channel, "preference")
            others = _list_substitutes(part, behaviour_set) if signal.channel == "gesture" else ()
            yield Candidate(part, signal, weight + CORE_BONUS * (signal.id in behaviour_set.core), choices, others)


def _list_substitutes(intent: Intent, behaviour_set: BehaviourSet) -> tuple[Choice, ...]:
    """Return gestures of an intent's meaning besides its lexemes.

    They are its own substitutes and the gestures of its behaviour set. An intent without lexemes has none.
    """
    if not intent.lexemes:
        return ()
    signals = (signal for signal in behaviour_set.signals if signal.channel == "gesture")
    of_set = [choice.lexeme for signal in signals for choice in signal.choices if choice.lexeme.lower() != NO_SIGNAL]
    names = dict.fromkeys((*intent.substitutes, *of_set))
    return tuple(Choice(name, 1.0) for name in names if name not in intent.lexemes)


def _draw_signals(
    intent: Intent, behaviour_set: BehaviourSet, agent: Agent, generator: random.Random
) -> Iterable[Signal]:
    signals = behaviour_set.signals
    if intent.lexemes:
        illustrating = tuple(Choice(lexeme, 1.0 / len(intent.lexemes)) for lexeme in intent.lexemes)
        signals = (
            *(signal for signal in signals if signal.channel != "gesture"),
            Signal("gesture", "gesture", illustrating),
        )
    shown = {signal.id for signal in signals if not _is_absent(signal, intent, agent, generator)} | behaviour_set.core
    for rule in behaviour_set.implications:
        if rule.given in shown:
            shown = shown | {rule.other} if rule.present else shown - ({rule.other} - behaviour_set.core)
    return [signal for signal in signals if signal.id in shown]


def _is_absent(signal: Signal, intent: Intent, agent: Agent, generator: random.Random) -> bool:
    """Draw randomly whether a signal is omitted.

    The probability follows from empty choices and the agent's activity.
    """
    activity = agent.weight(intent.name, signal.channel, "OAC")
    omission_probability = 1.0 - activity * (
        1.0 - sum(choice.probability for choice in signal.choices if choice.lexeme.lower() == NO_SIGNAL)
    )
    return omission_probability > 0.0 and generator.random() < omission_probability
