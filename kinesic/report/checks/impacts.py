"""Checks of contacts with people, under a chosen policy.

Planning keeps forces and energy within the policy. It cannot open gaps between the robot's own links, so that a large
clamping force only warns: a cover is the remedy.
"""

from kinesic.body.impact_policy import ENERGY_ROW
from kinesic.metrics.dry_run import DryRun
from kinesic.metrics.impact_figures import ImpactFigures
from kinesic.report.checks.check import Check, format_time

RATIO_TOLERANCE = 0.001  # accepted excess of a force over its limit, relative to the limit


def impact_checks(performance: DryRun) -> list[Check]:
    """Check energy, force and clamping force of contacts against their limits."""
    figures = performance.reference.impacts
    if figures is None or figures.policy is None:
        return []
    limits, energy = figures.policy.table, figures.worst[ENERGY_ROW]
    where = f"{energy.segment} {format_time(energy.time)}"
    return [
        Check.of("safety.energy", energy.value, limits.energy, where, slack=RATIO_TOLERANCE * limits.energy),
        _force(figures),
        _clamp(figures),
    ]


def _force(figures: ImpactFigures) -> Check:
    assert figures.policy is not None
    limits = figures.policy.table.force
    region = max(limits, key=lambda name: figures.worst[name].value / limits[name])
    contact = figures.worst[region]
    name = region.replace("_", " ")
    where = f"{contact.value:.0f} N on a free {name} by {contact.segment} {format_time(contact.time)}"
    return Check.of("safety.force", contact.value / limits[region], 1.0, where, slack=RATIO_TOLERANCE)


def _clamp(figures: ImpactFigures) -> Check:
    assert figures.policy is not None
    gap, limit = figures.largest_gap, figures.policy.table.clamp
    if gap is None:
        return Check.of("safety.clamp", 0.0, limit)
    where = f"{gap.pair[0]} and {gap.pair[1]} close to {1000 * gap.gap:.0f} mm {format_time(gap.time)}"
    return Check.of("safety.clamp", gap.force, limit, where)
