"""Contacts with people in `report.json`."""

from dataclasses import asdict

from kinesic.body.impact_policy import ENERGY_ROW, FORCE_MARGIN
from kinesic.metrics.dry_run import DryRun

Json = None | bool | int | float | str | list["Json"] | dict[str, "Json"]

IMPACT_DISCLAIMER = "Planned motion in a model. Not safety-rated, no risk assessment."  # printed with every figure


def describe_impacts(performance: DryRun) -> dict[str, Json] | None:
    """Describe the contacts of a performance, or return None without a model.

    The description has the force by region, the energy and the closing gap.
    """
    figures = performance.reference.impacts
    if figures is None:
        return None
    policy, gap, energy = figures.policy, figures.largest_gap, figures.worst[ENERGY_ROW]
    limits = {} if policy is None else policy.table.force
    forces: dict[str, Json] = {
        name: {
            "force_n": figures.worst[name].value,
            "limit_n": limits.get(name),
            "segment": figures.worst[name].segment,
            "at_s": figures.worst[name].time,
        }
        for name in figures.regions
    }
    clamp: Json = None if gap is None else {key: _plain(value) for key, value in asdict(gap).items()}
    return {
        "near": "nobody" if policy is None else policy.audience,
        "source": None if policy is None else f"{policy.table.source} ({policy.table.date})",
        "margin": FORCE_MARGIN,
        "forces": forces,
        "energy": {"energy_j": energy.value, "segment": energy.segment, "at_s": energy.time},
        "clamp": clamp,
        "note": IMPACT_DISCLAIMER,
    }


def _plain(value: object) -> Json:
    return list(value) if isinstance(value, tuple) else value if isinstance(value, int | float | str) else None
