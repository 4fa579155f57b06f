"""Random sequences of signals within an intention."""

import random
from collections.abc import Iterator, Sequence, Set
from dataclasses import replace

from kinesic.intent.behaviour_sets import BehaviourSet, Channel, Signal
from kinesic.intent.intents import Intent

SHORTEST_SIGNAL = 0.5  # [s] shortest visible duration of one gesture, nod or expression in a sequence


def draw_sequence(
    intent: Intent, behaviour_set: BehaviourSet, generator: random.Random
) -> Iterator[tuple[Intent, Signal]]:
    """Draw successive signals with their time spans within an intention.

    Every channel goes from signal to signal until the intention ends. Signals that do not repeat are shown once, and
    signals that exclude a shown one are not shown. A signal with low probability everywhere is drawn only if no other
    is left.
    """
    seconds = intent.end.seconds - intent.start.seconds
    shown, excluded = set[str](), set[str]()
    for channel in dict.fromkeys(signal.channel for signal in behaviour_set.signals):
        elapsed = 0.0
        while seconds - elapsed >= SHORTEST_SIGNAL or elapsed == 0.0:
            signal = _draw_signal(
                behaviour_set.signals, channel, elapsed / max(seconds, SHORTEST_SIGNAL), shown, excluded, generator
            )
            if signal is None or signal.spell is None:
                break
            duration = max(
                min(generator.uniform(signal.spell.least, signal.spell.most), seconds - elapsed), SHORTEST_SIGNAL
            )
            shown.add(signal.spell.name)
            excluded |= signal.spell.excludes
            start = intent.start.later(elapsed)
            yield replace(intent, start=start, stroke=start.later(duration / 2), end=start.later(duration)), signal
            elapsed += duration


def _draw_signal(
    signals: Sequence[Signal],
    channel: Channel,
    progress: float,
    shown: Set[str],
    excluded: Set[str],
    generator: random.Random,
) -> Signal | None:
    """Draw the next signal of a channel at random.

    Args:
        signals: of the set.
        channel: of the body.
        progress: 0..1 of the intention.
        shown: names of the spells drawn before.
        excluded: names that these exclude.
        generator: random generator.
    """
    free, weights = [], []
    for signal in signals:
        spell = signal.spell
        if signal.channel != channel or spell is None or spell.name in excluded or spell.excludes & shown:
            continue
        if spell.repeats or spell.name not in shown:
            free.append(signal)
            weights.append(max(spell.early + (spell.late - spell.early) * progress, 1e-6))
    return generator.choices(free, weights)[0] if free else None
