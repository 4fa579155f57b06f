"""Draws the signals of a set that follow one another: each for a while, likelier ones early or late."""

import random
from collections.abc import Iterator, Sequence, Set
from dataclasses import replace

from kinesic.intent.behaviour_sets import BehaviourSet, Channel, Signal
from kinesic.intent.intents import Intent

SHORTEST_SIGNAL = 0.5  # [s] in which a signal is still seen


def draw_sequence(intent: Intent, found: BehaviourSet, chance: random.Random) -> Iterator[tuple[Intent, Signal]]:
    """Yields signals with the part of an intention in which each is shown.

    Every channel goes from signal to signal until the intention ends. What does not repeat is shown once, what excludes
    something that was shown is not; a signal that is unlikely everywhere is drawn only where nothing else is left.
    """
    seconds = intent.end.seconds - intent.start.seconds
    shown, barred = set[str](), set[str]()
    for channel in dict.fromkeys(signal.channel for signal in found.signals):
        now = 0.0
        while seconds - now >= SHORTEST_SIGNAL or now == 0.0:
            signal = _drawn(found.signals, channel, now / max(seconds, SHORTEST_SIGNAL), shown, barred, chance)
            if signal is None or signal.spell is None:
                break
            lasts = max(min(chance.uniform(signal.spell.least, signal.spell.most), seconds - now), SHORTEST_SIGNAL)
            shown.add(signal.spell.name)
            barred |= signal.spell.excludes
            start = intent.start.later(now)
            yield replace(intent, start=start, stroke=start.later(lasts / 2), end=start.later(lasts)), signal
            now += lasts


def _drawn(
    signals: Sequence[Signal],
    channel: Channel,
    progress: float,
    shown: Set[str],
    barred: Set[str],
    chance: random.Random,
) -> Signal | None:
    """Draws the next signal of a channel; None where no one may follow.

    Args:
        signals: of the set.
        channel: of the body.
        progress: 0..1 of the intention.
        shown: names of spells that were drawn.
        barred: names that these exclude.
        chance: that draws.
    """
    free, weights = [], []
    for signal in signals:
        spell = signal.spell
        if signal.channel != channel or spell is None or spell.name in barred or spell.excludes & shown:
            continue
        if spell.repeats or spell.name not in shown:
            free.append(signal)
            weights.append(max(spell.early + (spell.late - spell.early) * progress, 1e-6))
    return chance.choices(free, weights)[0] if free else None
