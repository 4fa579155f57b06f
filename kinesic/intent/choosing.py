"""Chooses what shows each intent: behaviours from its set, within a budget, none in another's way."""

import random
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace

from kinesic.intent.behaviour_sets import NONE, BehaviourSet, BehaviourSets, Channel, Choice, Signal
from kinesic.intent.budget import MovementBudget
from kinesic.intent.greta.agent import Agent
from kinesic.intent.intents import Intent
from kinesic.intent.kept_intents import KeptIntents
from kinesic.intent.sequences import draw_sequence

RECENT = 3  # gestures within which none is repeated
WIDER = 2.5  # times their least distance, at which gestures are chosen first, so that they are spread over a text
SURE = 0.5  # certainty that these have at least
NEED = 0.05  # certainty that a core signal has more
NODS = "NOD"
DENIALS = frozenset({"negation", "negative"})  # intents in whose reach the head does not nod


@dataclass(frozen=True)
class ChosenBehaviour:
    """A behaviour that shows an intent."""

    channel: Channel
    lexeme: str
    intent: Intent
    amount: float | None = None
    repetition: int | None = None
    manner: Mapping[str, float] = field(default_factory=dict)  # numbers of expressivity, -1..1
    begin: str = ""  # when a hand sets out for it, in words of BML; empty: as early as it likes


@dataclass(frozen=True)
class Omission:
    """A signal, or a whole intent, that is not shown, and why."""

    intent: Intent
    channel: Channel | None  # None: nothing of it is shown
    why: str


@dataclass(frozen=True)
class Selection:
    """What shows the intents of a text, in the order of their strokes, and what was left out."""

    behaviours: tuple[ChosenBehaviour, ...]
    omissions: tuple[Omission, ...]
    replaced: tuple[ChosenBehaviour, ...] = ()  # earlier ones that give way to these


@dataclass(frozen=True)
class Earlier:
    """The behaviours that show the words before these."""

    fixed: tuple[ChosenBehaviour, ...] = ()  # it is done, or has begun
    free: tuple[ChosenBehaviour, ...] = ()  # it may still give way


NOTHING_BEFORE = Earlier()


@dataclass(frozen=True)
class _Candidate:
    """A signal that an intent asks for."""

    intent: Intent
    signal: Signal
    weight: float  # certainty, and more where it is needed
    choices: tuple[Choice, ...]
    earlier: ChosenBehaviour | None = None  # that it is already


def choose_behaviours(
    intents: Sequence[Intent],
    sets: BehaviourSets,
    budget: MovementBudget,
    *,
    seed: int = 0,
    agent: Agent | None = None,
    since: float = 0.0,
    earlier: Earlier = NOTHING_BEFORE,
    reachable: Callable[[Intent], Intent] = lambda intent: intent,
) -> Selection:
    """Chooses behaviours for all intents; the same intents, sets, budget and seed have the same behaviours.

    What is most certain goes first. Each channel has its own least distance; of gestures there are no more than the
    budget has, none like one of the two before it, and where a negation reaches no head nods.

    Args:
        intents: of one block.
        sets: what may show them.
        budget: how much there may be.
        seed: of what is drawn.
        agent: whose preferences and expressivity count; None: nobody's.
        since: [s] intents with earlier strokes are shown already; where they deny something no head nods all the same.
        earlier: what shows them. The budget is for these that may still give way and for what is chosen.
        reachable: moves the stroke of an intent that a gesture shows to where a hand can be.
    """
    agent = agent or Agent()
    chance = random.Random(seed)
    omitted: list[Omission] = []
    wanted: dict[Channel, list[_Candidate]] = {"gesture": [], "head": [], "face": [], "gaze": [], "torso": []}
    for intent in (each for each in intents if each.stroke.seconds >= since):
        found = sets.find(intent.name)
        if found is None:
            omitted.append(Omission(intent, None, f"no behaviour set is called {intent.name}"))
            continue
        candidates = list(_candidates(intent, found, agent, chance))
        for each in candidates:
            is_gesture = each.signal.channel == "gesture"
            wanted[each.signal.channel].append(replace(each, intent=reachable(each.intent)) if is_gesture else each)
        if not candidates:
            omitted.append(Omission(intent, None, f"the set of {intent.name} is empty"))
    chosen, replaced = list[ChosenBehaviour](), list[ChosenBehaviour]()
    for channel, all_of_it in wanted.items():
        fixed = [each for each in earlier.fixed if each.channel == channel]
        shown = KeptIntents(each.intent for each in fixed)
        free = [_stands(each) for each in earlier.free if each.channel == channel]
        denied = KeptIntents(each for each in intents if each.name in DENIALS)
        kept = _spaced([*free, *all_of_it], channel, denied, shown, budget, omitted)
        replaced += [each.earlier for each in free if each.earlier is not None and each not in kept]
        chosen += _with_lexemes(kept, channel, agent, chance, omitted, [each.lexeme for each in fixed])
    chosen.sort(key=lambda each: (each.intent.stroke.seconds, each.channel))
    return Selection(tuple(chosen), tuple(omitted), tuple(replaced))


def _stands(behaviour: ChosenBehaviour) -> _Candidate:
    """An earlier behaviour as a candidate that gives way to none of its own certainty."""
    choices = (Choice(behaviour.lexeme, 1.0),)
    signal = Signal(behaviour.channel, behaviour.channel, choices)
    return _Candidate(behaviour.intent, signal, behaviour.intent.certainty + NEED, choices, behaviour)


def _candidates(intent: Intent, found: BehaviourSet, agent: Agent, chance: random.Random) -> Iterable[_Candidate]:
    """The signals of a set that are to be shown: its core, what that demands, and others as chance has them."""
    if any(signal.spell for signal in found.signals):
        drawn = list(draw_sequence(intent, found, chance))
    else:
        drawn = [(intent, signal) for signal in _present(intent, found, agent, chance)]
    for when, signal in drawn:
        choices = tuple(each for each in signal.choices if each.lexeme.lower() != NONE)
        if choices:
            weight = intent.certainty * agent.share(intent.name, signal.channel, "preference")
            yield _Candidate(when, signal, weight + NEED * (signal.id in found.core), choices)


def _present(intent: Intent, found: BehaviourSet, agent: Agent, chance: random.Random) -> Iterable[Signal]:
    signals = found.signals
    if intent.lexemes:
        pictured = tuple(Choice(lexeme, 1.0 / len(intent.lexemes)) for lexeme in intent.lexemes)
        signals = (*(each for each in signals if each.channel != "gesture"), Signal("gesture", "gesture", pictured))
    shown = {each.id for each in signals if not _is_absent(each, intent, agent, chance)} | found.core
    for rule in found.implications:
        if rule.given in shown:
            shown = shown | {rule.other} if rule.present else shown - ({rule.other} - found.core)
    return [each for each in signals if each.id in shown]


def _is_absent(signal: Signal, intent: Intent, agent: Agent, chance: random.Random) -> bool:
    """Draws whether a signal is left out: by a choice that shows nothing, or as little as its agent moves."""
    activity = agent.share(intent.name, signal.channel, "OAC")
    nothing = 1.0 - activity * (1.0 - sum(each.probability for each in signal.choices if each.lexeme.lower() == NONE))
    return nothing > 0.0 and chance.random() < nothing


def _spaced(
    candidates: Sequence[_Candidate],
    channel: Channel,
    denied: KeptIntents,
    taken: KeptIntents,
    budget: MovementBudget,
    omitted: list[Omission],
) -> list[_Candidate]:
    """Keeps the most certain ones that are far enough apart and within the budget, in their order in time.

    Of gestures those that are sure and far apart are kept first, so that they are spread over a text.
    """
    budget = replace(budget, gestures=len(taken) + budget.gestures)
    ranked = sorted(candidates, key=lambda each: -each.weight)
    kept = list[_Candidate]()
    if channel == "gesture":
        spread = replace(budget, gaps={**budget.gaps, channel: WIDER * budget.gaps[channel]})
        kept = _keep([each for each in ranked if each.weight >= SURE], channel, denied, taken, spread, [])
    kept += _keep([each for each in ranked if each not in kept], channel, denied, taken, budget, omitted)
    return sorted(kept, key=lambda each: each.intent.stroke.seconds)


def _keep(
    ranked: Sequence[_Candidate],
    channel: Channel,
    denied: KeptIntents,
    taken: KeptIntents,
    budget: MovementBudget,
    omitted: list[Omission],
) -> list[_Candidate]:
    """Keeps the candidates, one after the other, against which nothing stands."""
    kept = list[_Candidate]()
    for each in ranked:
        why = _hindrance(each, channel, taken, denied, budget)
        if why:
            omitted.append(Omission(each.intent, channel, why))
        else:
            kept.append(each)
            taken.add(each.intent)
    return kept


def _hindrance(
    candidate: _Candidate, channel: Channel, kept: KeptIntents, denied: KeptIntents, budget: MovementBudget
) -> str:
    """Says what stands against a candidate; empty where nothing does."""
    intent, at = candidate.intent, candidate.intent.stroke.seconds
    if channel == "gesture" and len(kept) >= budget.gestures:
        return f"the budget of {budget.gestures} gestures is spent on what is more certain"
    if intent.certainty < budget.least_certainty.get(channel, 0.0):
        return f"{intent.certainty:.2f} is too uncertain for the {channel}"
    nods = channel == "head" and all(choice.lexeme == NODS for choice in candidate.choices)
    if nods and denied.reach(at, budget.gaps["head"]):
        return "nobody nods while he says no"
    other = kept.first_beside(intent, budget.gaps[channel], covering=channel in ("face", "head"))
    if other is None:
        return ""
    gap = abs(other.stroke.seconds - at)
    if gap < budget.gaps[channel]:
        return f"{gap:.1f} s from {other.name}, which is at least as certain, is too near for the {channel}"
    return f"the {channel} shows {other.name} meanwhile"


def _with_lexemes(
    kept: Sequence[_Candidate],
    channel: Channel,
    agent: Agent,
    chance: random.Random,
    omitted: list[Omission],
    before: Sequence[str],
) -> Iterable[ChosenBehaviour]:
    """Draws a choice for each candidate; of gestures one that was not among the last ones, those before counted."""
    recent = [*before][-(RECENT - 1) :]
    for each in kept:
        if each.earlier is not None:
            recent = [*recent, each.earlier.lexeme][-(RECENT - 1) :]
            continue
        free = [choice for choice in each.choices if channel != "gesture" or choice.lexeme not in recent]
        if not free:
            why = f"{each.choices[0].lexeme} was among the last {RECENT - 1} gestures"
            omitted.append(Omission(each.intent, channel, why))
            continue
        weights = [max(choice.probability, 1e-6) for choice in free]
        drawn = chance.choices(free, weights)[0]
        recent = [*recent, drawn.lexeme][-(RECENT - 1) :]
        manner = agent.manner(each.intent.name, channel, each.intent.strength)
        yield ChosenBehaviour(channel, drawn.lexeme, each.intent, drawn.amount, drawn.repetition, manner)
