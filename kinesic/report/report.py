"""The dry-run report as data: `report.json`, whose keys may grow but are never renamed."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict
from math import degrees
from time import perf_counter
from types import MappingProxyType

import numpy as np

from kinesic.bml.block import Behaviour, Block, modality_of
from kinesic.bml.feedback import prediction, warning
from kinesic.body.robot import SIDES
from kinesic.controller.performance import Performance
from kinesic.controller.smoothness import dimensionless_jerk, spectral_arc_length
from kinesic.controller.synchrony import median_lag
from kinesic.expressivity.hands.fingers import lacking_shapes
from kinesic.expressivity.keyframes import BodyMove
from kinesic.expressivity.style.resolve import resolve_numbers
from kinesic.expressivity.style.style import Style
from kinesic.expressivity.turns import turn_angles
from kinesic.ik import KERNEL
from kinesic.planning.plan import Plan
from kinesic.planning.syncs import SyncTime
from kinesic.realizer.feedback import Progress, agenda, span, times_of
from kinesic.report.checks import TOLERANCE, checks, grade
from kinesic.report.checks.plan import penetrations
from kinesic.report.checks.twin import measure_tracking
from kinesic.report.conditioning import story
from kinesic.report.labels import label
from kinesic.report.servo_belief import lead
from kinesic.report.speech import describe_speech
from kinesic.version import __version__

Json = None | bool | int | float | str | list["Json"] | dict[str, "Json"]

SCHEMA = 1
MISS_TO_NAME = 0.02  # [m] a hand that stays further from its target is named
UNSEEN: Mapping[SyncTime, float | None] = MappingProxyType({})  # nobody measured


def report(
    performance: Performance, *, source: str, seed: int = 0, beside: Sequence[Performance] = ()
) -> dict[str, Json]:
    """Gathers the data of `report.json` about one performance.

    Args:
        performance: what was planned and performed; the checks are of this one.
        source: name of the document.
        seed: of everything random.
        beside: the same plan in other twins, whose errors are told too.
    """
    plan = performance.plan
    began = perf_counter()
    verdicts = checks(performance)
    checking = perf_counter() - began
    return {
        "schema": SCHEMA,
        "kinesic": __version__,
        "robot": plan.setup.robot.name,
        "input": source,
        "style": _style(plan.setup.style, plan.timeline.block),
        "seed": seed,
        "variation": plan.setup.variation.amount,
        "idle": plan.setup.idling.amount,
        "kernel": KERNEL,
        "grade": grade(verdicts),
        "ok": grade(verdicts) != "fail",
        "checks": [asdict(check) for check in verdicts],
        "behaviours": _behaviours(performance),
        "whole_body": _whole_body(plan),
        "speech": describe_speech(plan),
        "sync": _syncs(performance),
        "synchrony": {"strokes": len(performance.stroke_lags), "median_s": median_lag(performance.stroke_lags)},
        "tracking": _tracking(performance),
        "limits": _limits(performance),
        "conditioning": _conditioning(performance),
        "collision": _collision(performance),
        "smoothness": _smoothness(performance),
        "power": _power(performance),
        "lead": lead(performance.believed),
        "learned": None,
        "twins": {each.twin_name: asdict(measure_tracking(each)) for each in (performance, *beside)},
        "warnings": [{"type": n.type.value, "id": n.id, "text": n.text} for n in plan.notices],
        "feedback": list(feedback(plan, performance.lags)),
        "timing": _timing(performance, checking),
    }


def _style(style: Style, block: Block) -> dict[str, Json]:
    """The numbers of each modality, and what was said beside the preset: by settings, and by the block.

    Those of gestures stand also beside the name, where readers of one modality find them.
    """
    tables: dict[str, Json] = {modality: dict(numbers) for modality, numbers in style.numbers().items()}
    said: dict[str, Json] = {
        modality: {name: value for name, value in asdict(manner).items() if value is not None}
        for modality, manner in block.manners.items()
    }
    tables |= {"settings": [str(setting) for setting in style.settings], "block": said}
    weights = {"whole_body": style.whole_body, "effort": style.effort}
    return {"name": style.name, **weights, **asdict(style.gesture), **tables}


def _manner(behaviour: Behaviour, plan: Plan) -> dict[str, Json] | None:
    """The numbers that a behaviour is moved with, and who said each; None when it moves nothing."""
    modality = modality_of(behaviour.action)
    if modality is None:
        return None
    found = resolve_numbers(plan.setup.style, modality, plan.timeline.block, behaviour)
    carried: dict[str, Json] = {"intensity": behaviour.manner.intensity}  # of Greta's signals
    return {"modality": modality, "values": asdict(found.expressivity), "sources": dict(found.sources), **carried}


def _behaviours(performance: Performance) -> list[Json]:
    plan = performance.plan
    found: list[Json] = []
    for behaviour in plan.timeline.block.behaviours:
        outcome = plan.keyframes.outcomes[behaviour.id]
        miss = plan.postures.misses.get(behaviour.id, 0.0)
        reasons = [outcome.why] if outcome.why else []
        if outcome.kind != "dropped" and miss > MISS_TO_NAME:
            reasons.append(f"hand stays {100 * miss:.0f} cm from its target, out of reach or too near the body")
        found.append(
            {
                "id": behaviour.id,
                "name": label(behaviour),
                "type": behaviour.type,
                "outcome": outcome.kind,
                "why": "; ".join(reasons),
                "reason": behaviour.reason,
                "manner": _manner(behaviour, plan),
                "body": _body(plan.keyframes.bodies.get(behaviour.id)),
                "shapes": _shapes(plan, behaviour.id),
            }
        )
    return found


def _shapes(plan: Plan, behaviour: str) -> dict[str, Json] | None:
    """Which hand shapes a behaviour asks for, and which of them the hand can make; None where it asks for none."""
    asked = plan.keyframes.shapes.get(behaviour, ())
    lacking = lacking_shapes(asked, plan.setup.robot)
    return {"asked": list(asked), "made": [shape for shape in asked if shape not in lacking]} if asked else None


def _whole_body(plan: Plan) -> dict[str, Json]:
    """How much the body takes part in gestures, in how many, and why in none."""
    robot, moves = plan.setup.robot, plan.keyframes.bodies.values()
    parts = {
        "neck": robot.joints("neck"),
        "trunk": robot.joints("torso"),
        "collar bones": [joint for side in SIDES for joint in robot.arm(side).lifting],
    }
    lacking = " and ".join(f"no {part}" for part, joints in parts.items() if not joints)
    return {
        "weight": plan.setup.style.whole_body,
        "gestures": sum(not move.still for move in moves),
        "lacking": f"robot {robot.name} has {lacking}" if lacking else "",
    }


def _body(move: BodyMove | None) -> dict[str, Json] | None:
    """What the rest of the body does beside the hands of a gesture; None where it does nothing."""
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


def _syncs(performance: Performance) -> list[Json]:
    block = performance.plan.timeline.block.id
    found: list[Json] = []
    tied = {(each.behaviour, each.sync): each for each in performance.stroke_lags}
    for sync in performance.plan.syncs:
        lag, force = performance.lags.get(sync, 0.0), tied.get((sync.behaviour, sync.sync))
        found.append(
            {
                "id": f"{block}:{sync.behaviour}:{sync.sync}",
                "asked_s": sync.asked,
                "planned_s": sync.planned,
                "twin_s": None if lag is None else sync.planned + lag,
                "amplitude": 1.0,
                "word": None if force is None else force.word,
                "accent_s": None if force is None else force.accent,
                "fastest_s": None if force is None else force.fastest,
                "fastest_lag_s": None if force is None else force.lag,
            }
        )
    return found


def _tracking(performance: Performance) -> dict[str, Json]:
    names = performance.plan.setup.robot.skeleton.names
    squares = np.degrees(np.nan_to_num(performance.errors)) ** 2
    means = squares.sum(axis=0) / np.maximum(performance.reference.moving.sum(axis=0), 1)
    found = performance.tracking
    late = performance.lateness
    return {
        "rmse_deg": found.rmse,
        "p95_deg": found.p95,
        "max_deg": found.max,
        "per_joint": {name: float(np.sqrt(mean)) for name, mean in zip(names, means, strict=True)},
        "lateness_s": {names[hinge]: float(late[hinge]) for hinge in np.flatnonzero(np.isfinite(late))},
    }


def _limits(performance: Performance) -> dict[str, Json]:
    shares = performance.reference.peaks.shares
    quantity, peak = max(shares.items(), key=lambda item: float(item[1].ratios.max()))
    return {
        "violations": int(sum((share.ratios > TOLERANCE).sum() for share in shares.values())),
        "worst": {
            "joint": performance.plan.setup.robot.skeleton.names[peak.hinge],
            "quantity": quantity,
            "ratio": float(peak.ratios[peak.hinge]),
            "time_s": peak.time,
        },
    }


def _conditioning(performance: Performance) -> dict[str, Json]:
    """What had to give, behaviour by behaviour, and how far each hinge strays from the desired motion."""
    plan = performance.plan
    strays = zip(plan.setup.robot.skeleton.names, np.degrees(plan.motion.lost), strict=True)
    return {
        "gave": [asdict(chapter) for chapter in story(performance)],
        "lost_deg": {name: float(lost) for name, lost in strays},
    }


def _collision(performance: Performance) -> dict[str, Json]:
    plan, measured = performance.plan, performance.measured
    nearest = min(
        ((plan.clearance, plan.clearance_times), (measured.clearance, measured.times)),
        key=lambda found: float(found[0].distances.min()),
    )
    clearance, times = nearest
    worst = clearance.worst
    return {
        "penetrations": penetrations(performance),
        "min_distance_m": float(clearance.distances[worst]),
        "pair": list(clearance.pairs[worst]),
        "time_s": float(times[worst]),
    }


def _smoothness(performance: Performance) -> dict[str, Json]:
    hands: dict[str, Json] = {}
    period = performance.period
    for side, performed in performance.measured.hands.items():
        planned = performance.reference.hands[side]
        hands[side] = {
            "dimensionless_jerk": dimensionless_jerk(planned, period=period),
            "sparc_planned": spectral_arc_length(planned, period=period),
            "sparc_twin": spectral_arc_length(performed, period=period),
        }
    return {"rms_jerk_rad_s3": performance.reference.peaks.rms_jerk, "hands": hands}


def _power(performance: Performance) -> dict[str, Json]:
    power, supply = performance.measured.power, performance.plan.setup.robot.supply
    return {
        "peak_a": float(power.peak.max()),
        "mean_a": float(power.mean.mean()),
        "supply_a": None if supply is None else supply.amps,
        "energy_j": power.energy,
        "warming_k": {name: float(rise.max()) for name, rise in power.warming.items()},
    }


def feedback(plan: Plan, lags: Mapping[SyncTime, float | None] = UNSEEN) -> Iterator[str]:
    """Yields the BML feedback of a performed block as it is sent: prediction, warnings, then the progress.

    Args:
        plan: of the block, whose time 0 is that of the messages.
        lags: how much later than planned the body was seen at sync points [s]; None: it never came.
    """
    block, times = plan.timeline.block, times_of(plan.syncs)
    start, _, end = span(times)
    yield prediction(block, start, end, times)
    for notice in plan.notices:
        yield warning(notice, character=block.character)
    seen_at = {(s.behaviour, s.sync): s.planned + lag for s, lag in lags.items() if lag is not None}
    for message in agenda(block.id, times, 0.0, sender=0, character=block.character):
        point = message.content
        measured = seen_at.get((point.behaviour or "", point.point)) if isinstance(point, Progress) else None
        yield message.xml if measured is None else message.measured_at(measured).xml


def _timing(performance: Performance, checking: float) -> dict[str, Json]:
    duration = performance.plan.duration
    parse, planned, dry = performance.parse_seconds, performance.plan.seconds, performance.dry_run_seconds + checking
    return {
        "parse_ms": 1000 * parse,
        "plan_ms": 1000 * planned,
        "first_command_ms": 1000 * (parse + planned),
        "dry_run_ms": 1000 * dry,
        "real_time_factor": duration / dry if dry else 0.0,
        "duration_s": duration,
        "zero_s": performance.plan.trajectory.zero,  # when block time is 0
    }
