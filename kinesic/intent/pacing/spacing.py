"""Selection of compatible candidates by certainty and spacing."""

from collections.abc import Sequence
from dataclasses import replace

from kinesic.intent.behaviour_sets import Channel
from kinesic.intent.behaviours import Omission
from kinesic.intent.budget import MovementBudget
from kinesic.intent.kept_intents import KeptIntents
from kinesic.intent.pacing.candidates import Candidate

WIDE_SPACING_FACTOR = 2.5  # factor on the smallest spacing of gestures that are chosen first
SURE_CERTAINTY = 0.5  # smallest certainty of gestures that are chosen first
NOD_LEXEME = "NOD"  # lexeme of a nod


def select_spaced(
    candidates: Sequence[Candidate],
    channel: Channel,
    negations: KeptIntents,
    taken: KeptIntents,
    budget: MovementBudget,
    omitted: list[Omission],
) -> list[Candidate]:
    """Keep the most certain candidates within spacing and budget, in time order.

    Of gestures those that are certain and far apart are kept first, so that they are spread over the text.
    """
    budget = replace(budget, gestures=len(taken) + budget.gestures)
    ranked = sorted(candidates, key=lambda candidate: -candidate.weight)
    kept = list[Candidate]()
    if channel == "gesture":
        spread = replace(budget, gaps={**budget.gaps, channel: WIDE_SPACING_FACTOR * budget.gaps[channel]})
        kept = _select(
            [candidate for candidate in ranked if candidate.weight >= SURE_CERTAINTY],
            channel,
            negations,
            taken,
            spread,
            [],
        )
    done = set(map(id, kept))
    rest = [candidate for candidate in ranked if id(candidate) not in done]
    kept += _select(rest, channel, negations, taken, budget, omitted)
    return sorted(kept, key=lambda candidate: candidate.intent.stroke.seconds)


def _select(
    ranked: Sequence[Candidate],
    channel: Channel,
    negations: KeptIntents,
    taken: KeptIntents,
    budget: MovementBudget,
    omitted: list[Omission],
) -> list[Candidate]:
    """Keep the candidates that no rule excludes, most certain first."""
    kept = list[Candidate]()
    for candidate in ranked:
        why = _find_omission_reason(candidate, channel, taken, negations, budget)
        if why:
            omitted.append(Omission(candidate.intent, channel, why))
        else:
            kept.append(candidate)
            taken.add(candidate.intent)
    return kept


def _find_omission_reason(
    candidate: Candidate, channel: Channel, kept: KeptIntents, negations: KeptIntents, budget: MovementBudget
) -> str:
    """Return the reason to omit a candidate, or an empty text."""
    intent, at = candidate.intent, candidate.intent.stroke.seconds
    if channel == "gesture" and len(kept) >= budget.gestures:
        return f"the budget of {budget.gestures} gestures is spent on more certain ones"
    if intent.certainty < budget.least_certainty.get(channel, 0.0):
        return f"{intent.certainty:.2f} is too uncertain for the {channel}"
    nods = channel == "head" and all(choice.lexeme == NOD_LEXEME for choice in candidate.choices)
    if nods and negations.covers(at, budget.gaps["head"]):
        return "the head does not nod during a negation"
    other = kept.first_conflict(intent, budget.gaps[channel], covering=channel in ("face", "head"))
    if other is None:
        return ""
    gap = abs(other.stroke.seconds - at)
    if gap < budget.gaps[channel]:
        return f"{gap:.1f} s from {other.name}, which is at least as certain, is too near for the {channel}"
    return f"the {channel} shows {other.name} at the same time"
