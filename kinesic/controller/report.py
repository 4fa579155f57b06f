"""The dry-run report as data: `report.json`, whose keys may grow but are never renamed."""

from dataclasses import asdict

import numpy as np

from kinesic import __version__
from kinesic.controller.checks import TOLERANCE, Check, checks
from kinesic.controller.messages import feedback
from kinesic.controller.performance import Performance
from kinesic.ik import KERNEL

Json = None | bool | int | float | str | list["Json"] | dict[str, "Json"]

SCHEMA = 1
MISS_TO_NAME = 0.02  # [m] a hand that stays further from its target is named


def report(performance: Performance, *, source: str, seed: int = 0) -> dict[str, Json]:
    """Everything that is known about one performance.

    Args:
        performance: what was planned and performed.
        source: name of the document.
        seed: of everything random.
    """
    plan = performance.plan
    verdicts = checks(performance)
    return {
        "schema": SCHEMA,
        "kinesic": __version__,
        "robot": plan.facts.robot.name,
        "input": source,
        "style": asdict(plan.facts.style),
        "seed": seed,
        "kernel": KERNEL,
        "ok": all(check.status != "fail" for check in verdicts),
        "checks": [_check(check) for check in verdicts],
        "behaviours": _behaviours(performance),
        "sync": _syncs(performance),
        "tracking": _tracking(performance),
        "limits": _limits(performance),
        "collision": _collision(performance),
        "smoothness": {"rms_jerk_rad_s3": _jerk(performance)},
        "warnings": [{"type": n.type.value, "id": n.id, "text": n.text} for n in plan.notices],
        "feedback": list(feedback(plan)),
        "timing": _timing(performance),
    }


def _check(check: Check) -> dict[str, Json]:
    return {
        "name": check.name,
        "status": check.status,
        "value": check.value,
        "limit": check.limit,
        "unit": check.unit,
        "where": check.where,
    }


def _behaviours(performance: Performance) -> list[Json]:
    plan = performance.plan
    found: list[Json] = []
    for behaviour in plan.timeline.block.behaviours:
        outcome = plan.keyframes.outcomes[behaviour.id]
        miss = plan.postures.misses.get(behaviour.id, 0.0)
        reasons = [outcome.why] if outcome.why else []
        if outcome.kind != "dropped" and miss > MISS_TO_NAME:
            reasons.append(f"hand stays {100 * miss:.0f} cm from its target, out of reach or too near the body")
        found.append({"id": behaviour.id, "type": behaviour.type, "outcome": outcome.kind, "why": "; ".join(reasons)})
    return found


def _syncs(performance: Performance) -> list[Json]:
    block = performance.plan.timeline.block.id
    found: list[Json] = []
    for sync in performance.plan.syncs:
        lag = performance.lags.get(sync, 0.0)
        found.append(
            {
                "id": f"{block}:{sync.behaviour}:{sync.sync}",
                "asked_s": sync.asked,
                "planned_s": sync.planned,
                "twin_s": None if lag is None else sync.planned + lag,
                "amplitude": 1.0,
            }
        )
    return found


def _tracking(performance: Performance) -> dict[str, Json]:
    errors = np.degrees(np.abs(performance.errors))
    names = performance.plan.facts.robot.skeleton.names
    moved = errors[np.isfinite(errors)]
    per_joint: dict[str, Json] = {}
    for name, column in zip(names, errors.T, strict=True):
        own = column[np.isfinite(column)]
        per_joint[name] = float(np.sqrt(np.mean(own**2))) if len(own) else 0.0
    return {
        "rmse_deg": float(np.sqrt(np.mean(moved**2))) if len(moved) else 0.0,
        "p95_deg": float(np.percentile(moved, 95)) if len(moved) else 0.0,
        "max_deg": float(moved.max()) if len(moved) else 0.0,
        "per_joint": per_joint,
    }


def _limits(performance: Performance) -> dict[str, Json]:
    names = performance.plan.facts.robot.skeleton.names
    ratios = performance.ratios
    quantity = max(ratios, key=lambda name: float(ratios[name].max()))
    hinge = int(ratios[quantity].argmax())
    return {
        "violations": int(sum((peaks > TOLERANCE).sum() for peaks in ratios.values())),
        "worst": {"joint": names[hinge], "quantity": quantity, "ratio": float(ratios[quantity][hinge])},
    }


def _collision(performance: Performance) -> dict[str, Json]:
    plan, measured = performance.plan, performance.measured
    nearest = min(
        ((plan.clearance, plan.clearance_times), (measured.clearance, measured.times)),
        key=lambda found: float(found[0].distances.min()),
    )
    clearance, times = nearest
    worst = clearance.worst
    overlaps = [int((found.distances < 0.0).sum()) for found in (plan.clearance, measured.clearance)]
    return {
        "penetrations": sum(overlaps),
        "min_distance_m": float(clearance.distances[worst]),
        "pair": list(clearance.pairs[worst]),
        "time_s": float(times[worst]),
    }


def _jerk(performance: Performance) -> float:
    """Root mean square jerk over all hinges and the whole motion [rad/s^3].

    Three Gauss points are exact for the square of a quintic's jerk.
    """
    trajectory = performance.plan.trajectory
    nodes, weights = np.polynomial.legendre.leggauss(3)
    total = 0.0
    for curve in trajectory.curves:
        steps = np.diff(curve.x)
        times = curve.x[:-1, None] + steps[:, None] * (nodes + 1) / 2
        total += float((steps / 2 * (curve(times, nu=3) ** 2 @ weights)).sum())
    return float(np.sqrt(total / trajectory.duration / len(trajectory.curves)))


def _timing(performance: Performance) -> dict[str, Json]:
    duration = performance.plan.duration
    parse, planned, dry = performance.parse_seconds, performance.plan.seconds, performance.dry_run_seconds
    return {
        "parse_ms": 1000 * parse,
        "plan_ms": 1000 * planned,
        "first_command_ms": 1000 * (parse + planned),
        "dry_run_ms": 1000 * dry,
        "real_time_factor": duration / dry if dry else 0.0,
        "duration_s": duration,
    }
