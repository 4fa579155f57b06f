"""Content of `report.json`, whose keys are a stable format."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict
from math import degrees
from time import perf_counter
from types import MappingProxyType

import numpy as np

from kinesic.bml.block import Behaviour, Block, find_modality
from kinesic.bml.feedback import write_prediction, write_warning
from kinesic.body.robot import SIDES
from kinesic.expressivity.keyframes import BodyMove
from kinesic.expressivity.style.style import Style
from kinesic.expressivity.turns import turn_angles
from kinesic.files.unicode_text import escape_surrogates
from kinesic.metrics.dry_run import DryRun
from kinesic.planning.plan import Plan
from kinesic.planning.syncs import SyncTime
from kinesic.realizer.feedback import Progress, block_span, schedule_feedback, times_by_behaviour
from kinesic.report.checks import LIMIT_TOLERANCE, checks, grade
from kinesic.report.checks.plan import penetrations
from kinesic.report.checks.twin import measure_tracking
from kinesic.report.impacts import describe_impacts
from kinesic.report.labels import label
from kinesic.report.servo_estimate import describe_assumed
from kinesic.report.speech import describe_speech
from kinesic.version import __version__

Json = None | bool | int | float | str | list["Json"] | dict[str, "Json"]

SCHEMA_VERSION = 1  # version of the report.json format
MIN_REPORTED_MISS = 0.02  # [m] smallest reported distance of a hand from its target
HAND_NAMES = {"l": "left", "r": "right"}  # side -> name of a hand in report.json
NO_LAGS: Mapping[SyncTime, float | None] = MappingProxyType(  # default: no measured delays, empty
    {}
)  # sync point delays of a performance without measurements


def report(performance: DryRun, *, source: str, seed: int = 0, other_runs: Sequence[DryRun] = ()) -> dict[str, Json]:
    """Return the content of `report.json` for one performance.

    Args:
        performance: planned and performed motion; the checks are of this one.
        source: name of the document.
        seed: seed of all random choices.
        other_runs: the same plan in other twins, whose errors are included.
    """
    plan, began = performance.plan, perf_counter()
    verdicts = checks(performance)
    timing = _timing(performance, perf_counter() - began)
    return {
        "schema": SCHEMA_VERSION,
        "kinesic": __version__,
        "robot": plan.setup.robot.name,
        "input": escape_surrogates(source),
        "style": _style(plan.setup.style, plan.timeline.block),
        "seed": seed,
        "variation": plan.setup.variation.amount,
        "idle": plan.setup.idling.amount,
        "prosody": plan.setup.prosody,
        "kernel": "compiled",  # the only one; readers of earlier reports look it up
        "grade": grade(verdicts),
        "ok": grade(verdicts) != "fail",
        "checks": [asdict(check) for check in verdicts],
        "behaviours": _behaviours(performance),
        "whole_body": _whole_body(plan),
        "speech": describe_speech(plan),
        "sync": _syncs(performance),
        "synchrony": {"strokes": len(performance.stroke_lags), "median_s": performance.median_stroke_lag},
        "tracking": _tracking(performance),
        "limits": _limits(performance),
        "conditioning": _conditioning(performance),
        "collision": _collision(performance),
        "contact": describe_impacts(performance),
        "smoothness": _smoothness(performance),
        "power": _power(performance),
        "lead": describe_assumed(performance.servo_estimate),
        "learned": None,
        "twins": {run.twin_name: asdict(measure_tracking(run)) for run in (performance, *other_runs)},
        "warnings": [{"type": n.type.value, "id": n.id, "text": n.text} for n in plan.notices],
        "feedback": list(feedback(plan, performance.lags)),
        "timing": timing,
    }


def _style(style: Style, block: Block) -> dict[str, Json]:
    """Return style parameters per modality, with changes by settings and block.

    Those of gestures are repeated beside the name, for readers of one modality.
    """
    tables: dict[str, Json] = {modality: dict(numbers) for modality, numbers in style.numbers().items()}
    changes: dict[str, Json] = {
        modality: {name: value for name, value in asdict(manner).items() if value is not None}
        for modality, manner in block.manners.items()
    }
    tables |= {"settings": [str(setting) for setting in style.settings], "block": changes}
    weights = {"whole_body": style.whole_body, "posture": style.posture, "effort": style.effort}
    return {"name": style.name, **weights, **asdict(style.gesture), **tables}


def _expressivity(behaviour: Behaviour, plan: Plan) -> dict[str, Json] | None:
    """Return a behaviour's expressivity parameters and the source of each."""
    modality = find_modality(behaviour.action)
    if modality is None:
        return None
    numbers = plan.numbers[behaviour.id]
    carried: dict[str, Json] = {"intensity": behaviour.manner.intensity}  # of Greta's signals
    return {"modality": modality, "values": asdict(numbers.expressivity), "sources": dict(numbers.sources), **carried}


def _behaviours(performance: DryRun) -> list[Json]:
    plan = performance.plan
    rows: list[Json] = []
    for behaviour in plan.timeline.block.behaviours:
        outcome = plan.keyframes.outcomes[behaviour.id]
        miss = plan.postures.misses.get(behaviour.id, 0.0)
        reasons = [outcome.why] if outcome.why else []
        if outcome.kind != "dropped" and miss > MIN_REPORTED_MISS:
            reasons.append(f"hand stays {100 * miss:.0f} cm from its target, out of reach or too near the body")
        rows.append(
            {
                "id": behaviour.id,
                "name": label(behaviour),
                "type": behaviour.type,
                "outcome": outcome.kind,
                "why": "; ".join(reasons),
                "reason": behaviour.reason,
                "hands": _hands(plan, behaviour.id),
                "manner": _expressivity(behaviour, plan),
                "body": _body(plan.keyframes.bodies.get(behaviour.id)),
                "shapes": _shapes(plan, behaviour.id),
            }
        )
    return rows


def _hands(plan: Plan, behaviour: str) -> list[Json]:
    """Return the names of the hands that perform a behaviour."""
    uses = plan.keyframes.uses.get(behaviour, frozenset())
    return [name for side, name in HAND_NAMES.items() if f"{side}_hand" in uses]


def _shapes(plan: Plan, behaviour: str) -> dict[str, Json] | None:
    """Return a behaviour's requested and feasible hand shapes, or None."""
    requested_shapes, lacking = plan.keyframes.shapes.get(behaviour, ()), plan.missing_shapes.get(behaviour, ())
    return (
        {"asked": list(requested_shapes), "made": [shape for shape in requested_shapes if shape not in lacking]}
        if requested_shapes
        else None
    )


def _whole_body(plan: Plan) -> dict[str, Json]:
    """Return whole-body style weight, number of gestures with body motion, missing joints."""
    robot, moves = plan.setup.robot, plan.keyframes.bodies.values()
    parts = {
        "neck": robot.joints("neck"),
        "trunk": robot.joints("torso"),
        "collar bones": [joint for side in SIDES for joint in robot.arm(side).shoulder_lift_joints],
    }
    lacking = " and ".join(f"no {part}" for part, joints in parts.items() if not joints)
    return {
        "weight": plan.setup.style.whole_body,
        "gestures": sum(not move.still for move in moves),
        "lacking": f"robot {robot.name} has {lacking}" if lacking else "",
    }


def _body(move: BodyMove | None) -> dict[str, Json] | None:
    """Return the body motion that accompanies a gesture, or None."""
    if move is None:
        return None
    head = max(abs(move.head.tilt + move.nod), abs(move.head.torsion) + abs(move.shake), abs(move.head.roll))
    return {
        "head_deg": degrees(head),
        "trunk_deg": degrees(max(map(abs, turn_angles(move.trunk)))),
        "shoulders_deg": degrees(move.shoulders),
        "eyes_deg": None if move.eyes is None else [degrees(move.eyes.torsion), -degrees(move.eyes.tilt)],
        "face": dict(move.face),
        "gave_way": list(move.gave_way),
    }


def _syncs(performance: DryRun) -> list[Json]:
    block = performance.plan.timeline.block.id
    rows: list[Json] = []
    tied = {(stroke_lag.behaviour, stroke_lag.sync): stroke_lag for stroke_lag in performance.stroke_lags}
    for sync in performance.plan.syncs:
        lag, force = performance.lags.get(sync, 0.0), tied.get((sync.behaviour, sync.sync))
        rows.append(
            {
                "id": f"{block}:{sync.behaviour}:{sync.sync}",
                "asked_s": sync.requested,
                "planned_s": sync.planned,
                "twin_s": None if lag is None else sync.planned + lag,
                "amplitude": 1.0,
                "word": None if force is None else force.word,
                "accent_s": None if force is None else force.accent,
                "fastest_s": None if force is None else force.fastest,
                "fastest_lag_s": None if force is None else force.lag,
            }
        )
    return rows


def _tracking(performance: DryRun) -> dict[str, Json]:
    names = performance.plan.setup.robot.skeleton.names
    squares = np.degrees(np.nan_to_num(performance.errors)) ** 2
    means = squares.sum(axis=0) / np.maximum(performance.reference.moving.sum(axis=0), 1)
    tracking = performance.tracking
    late = performance.tracking_delays
    return {
        "rmse_deg": tracking.rmse,
        "p95_deg": tracking.p95,
        "max_deg": tracking.max,
        "per_joint": {name: float(np.sqrt(mean)) for name, mean in zip(names, means, strict=True)},
        "lateness_s": {names[hinge]: float(late[hinge]) for hinge in np.flatnonzero(np.isfinite(late))},
    }


def _limits(performance: DryRun) -> dict[str, Json]:
    shares = performance.reference.peaks.by_quantity
    quantity, peak = max(shares.items(), key=lambda item: float(item[1].ratios.max()))
    return {
        "violations": int(sum((share.ratios > LIMIT_TOLERANCE).sum() for share in shares.values())),
        "worst": {
            "joint": performance.plan.setup.robot.skeleton.names[peak.hinge],
            "quantity": quantity,
            "ratio": float(peak.ratios[peak.hinge]),
            "time_s": peak.time,
        },
    }


def _conditioning(performance: DryRun) -> dict[str, Json]:
    """Return changes made to keep limits, and each joint's RMS deviation [deg]."""
    plan = performance.plan
    strays = zip(plan.setup.robot.skeleton.names, np.degrees(plan.motion.rms_distances), strict=True)
    return {
        "gave": [asdict(chapter) for chapter in performance.reference.changes],
        "lost_deg": {name: float(lost) for name, lost in strays},
    }


def _collision(performance: DryRun) -> dict[str, Json]:
    plan, measured = performance.plan, performance.measured
    nearest = min(
        ((plan.clearance, plan.clearance_times), (measured.clearance, measured.times)),
        key=lambda clearance_with_times: float(clearance_with_times[0].distances.min()),
    )
    clearance, times = nearest
    worst = clearance.worst
    return {
        "penetrations": penetrations(performance),
        "min_distance_m": float(clearance.distances[worst]),
        "pair": list(clearance.pairs[worst]),
        "time_s": float(times[worst]),
    }


def _smoothness(performance: DryRun) -> dict[str, Json]:
    hands: dict[str, Json] = {
        side: {
            "dimensionless_jerk": hand.planned_jerk,
            "sparc_planned": hand.planned_arc_length,
            "sparc_twin": hand.performed_arc_length,
        }
        for side, hand in performance.hand_smoothness.items()
    }
    return {"rms_jerk_rad_s3": performance.reference.peaks.rms_jerk, "hands": hands}


def _power(performance: DryRun) -> dict[str, Json]:
    power, supply = performance.measured.power, performance.plan.setup.robot.supply
    return {
        "peak_a": float(power.peak.max()),
        "mean_a": float(power.mean.mean()),
        "supply_a": None if supply is None else supply.amps,
        "energy_j": power.energy,
        "warming_k": {name: float(rise.max()) for name, rise in power.warming.items()},
    }


def feedback(plan: Plan, lags: Mapping[SyncTime, float | None] = NO_LAGS) -> Iterator[str]:
    """Yield the BML feedback of a performed block: prediction, warnings, progress.

    Args:
        plan: plan of the block; its time 0 is that of the messages.
        lags: measured delays of sync points [s]; None if the body never arrived.
    """
    block, times = plan.timeline.block, times_by_behaviour(plan.syncs)
    start, _, end = block_span(times)
    yield write_prediction(block, start, end, times)
    for notice in plan.notices:
        yield write_warning(notice, character=block.character)
    seen_at = {(s.behaviour, s.sync): s.planned + lag for s, lag in lags.items() if lag is not None}
    for message in schedule_feedback(block.id, times, 0.0, sender=0, character=block.character):
        point = message.content
        measured = seen_at.get((point.behaviour or "", point.point)) if isinstance(point, Progress) else None
        yield message.xml if measured is None else message.measured_at(measured).xml


def _timing(performance: DryRun, checking: float) -> dict[str, Json]:
    duration = performance.plan.duration
    parse, planned, dry = (
        performance.plan.parse_seconds,
        performance.plan.seconds,
        performance.dry_run_seconds + checking,
    )
    return {
        "parse_ms": 1000 * parse,
        "plan_ms": 1000 * planned,
        "first_command_ms": 1000 * (parse + planned),
        "dry_run_ms": 1000 * dry,
        "real_time_factor": duration / dry if dry else 0.0,
        "duration_s": duration,
        "zero_s": performance.plan.trajectory.zero,  # when block time is 0
    }
