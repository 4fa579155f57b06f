"""Legibility of gestures: hands in the required positions and distinct meanings."""

from collections.abc import Iterable, Mapping, Sequence
from math import degrees

from kinesic.bench.metric import Metric
from kinesic.bench.naturalness.likeness import Pair, nearest_pairs
from kinesic.bench.naturalness.places import FACE_POINTS
from kinesic.body.arrays import Floats
from kinesic.expressivity.lexicon.legibility_table import LegibilityTable

ALIKE_DISTANCE = 0.05  # [m] distance below which two gestures look alike
LISTING_DISTANCE = 0.08  # [m] largest distance between two gestures that are listed as similar
HEAD_ALIKE_DISTANCE = 0.08  # [m] distance below which gestures at the head look alike
NAMED_PAIRS = 5  # maximum number of gesture pairs, or gestures, named in the note of a metric


def different_pairs(seen: Mapping[str, Floats], table: LegibilityTable) -> list[Pair]:
    """List similar gesture pairs with different meanings, the most similar first.

    Their distance is at most `LISTING_DISTANCE`.
    """
    return [pair for pair in nearest_pairs(seen, LISTING_DISTANCE) if not table.may_be_alike(pair.a, pair.b)]


def legibility_metrics(
    part: str, seen: Mapping[str, Floats], places: Mapping[str, float], table: LegibilityTable
) -> list[Metric]:
    """Count gestures that look alike, and hands outside their required positions.

    Args:
        part: prefix of the metric names.
        seen: visible points of each gesture's stroke (m, p, 3) [m].
        places: distance [m] from the required position, by gesture.
        table: requirements.
    """
    pairs = different_pairs(seen, table)
    alike = [pair for pair in pairs if pair.distance < ALIKE_DISTANCE]
    misplaced = [name for name, distance in places.items() if distance > table.places[name].within]
    metrics = [
        Metric(f"{part}.alike", float(len(alike)), "pairs", 0.0, "lower", describe_pairs(alike)),
        Metric(f"{part}.misplaced", float(len(misplaced)), "gestures", 0.0, "lower", ", ".join(misplaced)),
    ]
    if pairs:
        nearest = 1000 * pairs[0].distance
        metrics.append(
            Metric(
                f"{part}.nearest_pair",
                nearest,
                "mm",
                1000 * ALIKE_DISTANCE,
                "higher",
                describe_pairs(pairs[:NAMED_PAIRS]),
            )
        )
    at_head = {name for name, requirement in table.places.items() if requirement.at in FACE_POINTS}
    alike_at_head = [pair for pair in pairs if {pair.a, pair.b} <= at_head and pair.distance < HEAD_ALIKE_DISTANCE]
    metrics.append(
        Metric(
            f"{part}.alike_at_head",
            float(len(alike_at_head)),
            "pairs",
            None,
            "lower",
            describe_pairs(alike_at_head[:NAMED_PAIRS]),
        )
    )
    if places:
        farthest = 1000 * max(places.values())
        metrics.append(Metric(f"{part}.farthest_place", farthest, "mm", None, "lower", _describe_farthest(places)))
    return metrics


def shoulder_metric(part: str, lifts: Mapping[str, float], table: LegibilityTable) -> Metric:
    """Count gestures whose shoulders do not rise as required.

    Args:
        part: prefix of the metric name.
        lifts: rotation [rad] of the shoulder that rises more, by gesture.
        table: requirements.
    """
    low = [name for name, min_lift in table.shoulders.items() if name in lifts and degrees(lifts[name]) < min_lift]
    return Metric(f"{part}.low_shoulders", float(len(low)), "gestures", 0.0, "lower", ", ".join(low))


def describe_pairs(pairs: Sequence[Pair]) -> str:
    """Return gesture names and distances [mm] of pairs as text."""
    return ", ".join(f"{pair.a} and {pair.b} {1000 * pair.distance:.0f}" for pair in pairs)


def _describe_farthest(places: Mapping[str, float]) -> str:
    """Return the gestures farthest from their required positions as text."""
    farthest: Iterable[str] = sorted(places, key=lambda name: -places[name])[:NAMED_PAIRS]
    return ", ".join(f"{name} {1000 * places[name]:.0f}" for name in farthest)
