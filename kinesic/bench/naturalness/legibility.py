"""Whether gestures can be read: hands where their meaning needs them, and no two alike that mean different things."""

from collections.abc import Iterable, Mapping, Sequence
from math import degrees

from kinesic.bench.figure import Figure
from kinesic.bench.naturalness.likeness import Pair, nearest_pairs
from kinesic.bench.naturalness.places import FACE
from kinesic.body.arrays import Floats
from kinesic.expressivity.lexicon.legibility_table import LegibilityTable

TOO_NEAR = 0.05  # [m] below which two gestures look alike
LISTED = 0.08  # [m] up to which pairs are looked for
APART_AT_HEAD = 0.08  # [m] likewise of gestures at the head, which look alike sooner
SHOWN = 5  # pairs that are named


def different_pairs(seen: Mapping[str, Floats], table: LegibilityTable) -> list[Pair]:
    """Lists the nearest pairs of gestures that mean different things, the nearest first."""
    return [pair for pair in nearest_pairs(seen, LISTED) if not table.may_be_alike(pair.a, pair.b)]


def legibility_figures(
    part: str, seen: Mapping[str, Floats], places: Mapping[str, float], table: LegibilityTable
) -> list[Figure]:
    """Counts gestures that are taken for others, and hands that are not in their place.

    Args:
        part: what the names of the figures begin with.
        seen: (m, p, 3) [m] what is seen of each gesture's stroke.
        places: [m] from the place that a gesture needs, by gesture.
        table: what is asked.
    """
    pairs = different_pairs(seen, table)
    alike = [pair for pair in pairs if pair.distance < TOO_NEAR]
    away = [name for name, distance in places.items() if distance > table.places[name].within]
    figures = [
        Figure(f"{part}.alike", float(len(alike)), "pairs", 0.0, "lower", told(alike)),
        Figure(f"{part}.misplaced", float(len(away)), "gestures", 0.0, "lower", ", ".join(away)),
    ]
    if pairs:
        nearest = 1000 * pairs[0].distance
        figures.append(Figure(f"{part}.nearest_pair", nearest, "mm", 1000 * TOO_NEAR, "higher", told(pairs[:SHOWN])))
    at_head = {name for name, asked in table.places.items() if asked.at in FACE}
    near = [pair for pair in pairs if {pair.a, pair.b} <= at_head and pair.distance < APART_AT_HEAD]
    figures.append(Figure(f"{part}.alike_at_head", float(len(near)), "pairs", None, "lower", told(near[:SHOWN])))
    if places:
        farthest = 1000 * max(places.values())
        figures.append(Figure(f"{part}.farthest_place", farthest, "mm", None, "lower", _ordered(places)))
    return figures


def shoulder_figure(part: str, lifts: Mapping[str, float], table: LegibilityTable) -> Figure:
    """Counts gestures whose shoulders should rise, and do not.

    Args:
        part: what the name of the figure begins with.
        lifts: [rad] of the shoulder that rises more, by gesture.
        table: what is asked.
    """
    low = [name for name, least in table.shoulders.items() if name in lifts and degrees(lifts[name]) < least]
    return Figure(f"{part}.low_shoulders", float(len(low)), "gestures", 0.0, "lower", ", ".join(low))


def told(pairs: Sequence[Pair]) -> str:
    """Names pairs and their distances [mm]."""
    return ", ".join(f"{pair.a} and {pair.b} {1000 * pair.distance:.0f}" for pair in pairs)


def _ordered(places: Mapping[str, float]) -> str:
    """The gestures farthest from their places."""
    far: Iterable[str] = sorted(places, key=lambda name: -places[name])[:SHOWN]
    return ", ".join(f"{name} {1000 * places[name]:.0f}" for name in far)
