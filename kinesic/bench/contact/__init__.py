"""Benchmark of contacts between a moving robot and people.

It measures plans under a policy, and collisions of the twin.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from time import process_time

import numpy as np

from kinesic.bench.blocks import find_corpus, plan_corpus
from kinesic.bench.contact.collisions import GESTURE_BLOCK, collide
from kinesic.bench.contact.independent_forces import MujocoContacts
from kinesic.bench.metric import Metric
from kinesic.bml.block import Block
from kinesic.body.choices import Audience
from kinesic.body.config import names_of
from kinesic.body.impact_policy import find_policy, read_impact_limits
from kinesic.planning.impact_limits import compute_impact_ratios, knot_times
from kinesic.planning.plan import Plan
from kinesic.planning.setup import Setup
from kinesic.planning.standing_plan import plan_standing_block
from kinesic.planning.syncs import SHIFT_TO_WARN
from kinesic.session.documents import read_block
from kinesic.session.setup import set_up

MAX_SURVEY_RATIO = 0.05  # goal: CPU time of one evaluation of contacts / CPU time of planning
COMPARED_ROBOTS = ("upper22", "upper36")  # robots whose plans are compared
POLICY_AUDIENCE: Audience = "adult"  # people near the robot, whose contact limits are applied
DOCUMENT_COUNT = 100  # number of corpus documents
COLLISION_COUNT = 200  # number of collisions with each robot
SURVEY_REPEATS = 5  # number of evaluations of one motion whose CPU time is averaged


@dataclass(frozen=True, eq=False)
class ComparedPlan:
    """One block planned without and with contact limits."""

    name: str
    ratio_before: float  # largest force / limit, planned without contact limits
    ratio: float  # largest force / limit, planned with contact limits, by independent code
    shift: float  # [s] largest additional shift of a stroke
    stretch: float  # motion duration with contact limits / duration without
    dropped: int  # number of behaviours dropped because of the contact limits
    seconds: tuple[float, float]  # [s] CPU time of planning without and with contact limits
    survey_seconds: float  # [s] CPU time of one evaluation of all contacts


def bench() -> list[Metric]:
    """Compare plans without and with contact limits, and measure collisions."""
    metrics: list[Metric] = []
    for robot in COMPARED_ROBOTS:
        metrics += bench_gestures(robot, names_of("style"))
        metrics += bench_documents(robot, DOCUMENT_COUNT)
        metrics += bench_collisions(robot, COLLISION_COUNT)
    return metrics


def bench_gestures(robot: str, styles: Sequence[str], *, every: int = 1) -> list[Metric]:
    """Compare plans of single gestures in given styles.

    Args:
        robot: name.
        styles: names of styles.
        every: stride through the gestures.
    """
    compared: list[ComparedPlan] = []
    for style in styles:
        setup = set_up(robot, style=style)
        lexemes = sorted(form.id for form in setup.lexicon.forms)[::every]
        blocks = [read_block(GESTURE_BLOCK.format(lexeme), setup, source=f"{lexeme} ({style})") for lexeme in lexemes]
        compared += compare_plans(blocks, setup)
    return summarise_plans(f"contact.{robot}.gestures", compared)


def bench_documents(robot: str, count: int) -> list[Metric]:
    """Compare plans of corpus documents."""
    prefix = f"contact.{robot}.documents"
    corpus = find_corpus()
    if corpus is None:
        return [Metric(f"{prefix}.plans", None, "plans", None, "higher", "no corpus (KINESIC_CORPUS)")]
    setup = set_up(robot)
    blocks = [planned.timeline.block for planned in plan_corpus(corpus, setup, count)]
    return summarise_plans(prefix, compare_plans(blocks, setup))


def bench_collisions(robot: str, count: int) -> list[Metric]:
    """Compare forces of collisions with their bounds."""
    setup = set_up(robot, near=POLICY_AUDIENCE)
    lexemes = sorted(form.id for form in setup.lexicon.forms)
    found = list(collide(setup, lexemes, read_impact_limits().regions, count))
    ratios = np.array([collision.ratio for collision in found])
    worst = found[int(ratios.argmax())]
    where = f"{worst.lexeme}: {worst.peak:.0f} of {worst.bound:.0f} N on a {worst.region}"
    prefix = f"contact.{robot}.collisions"
    return [
        Metric(f"{prefix}.count", float(count), "collisions", None, "higher"),
        Metric(f"{prefix}.ratio_p50", float(np.median(ratios)), "of bound", None, "lower"),
        Metric(f"{prefix}.ratio_max", float(ratios.max()), "of bound", 1.0, "lower", where),
    ]


def compare_plans(blocks: Sequence[Block], setup: Setup, *, near: Audience = POLICY_AUDIENCE) -> list[ComparedPlan]:
    """Plan blocks without and with contact limits, and measure both plans."""
    policy = find_policy(near)
    assert policy is not None
    limited, contacts = replace(setup, policy=policy), MujocoContacts(setup.robot)
    compared = []
    for block in blocks:
        (before, seconds), (after, more_seconds) = _time_plan(block, setup), _time_plan(block, limited)
        compared.append(
            ComparedPlan(
                name=block.source,
                ratio_before=contacts.largest_ratio(before.trajectory, policy.rows),
                ratio=contacts.largest_ratio(after.trajectory, policy.rows),
                shift=_largest_shift(before, after),
                stretch=after.trajectory.duration / before.trajectory.duration,
                dropped=max(0, _count_dropped(after) - _count_dropped(before)),
                seconds=(seconds, more_seconds),
                survey_seconds=_time_survey(after),
            )
        )
    return compared


def _time_plan(block: Block, setup: Setup) -> tuple[Plan, float]:
    began = process_time()
    planned = plan_standing_block(block, setup)
    return planned, process_time() - began


def _time_survey(planned: Plan) -> float:
    """Measure the CPU time [s] of evaluating a motion's contacts once."""
    times = knot_times(planned.trajectory)
    began = process_time()
    for _ in range(SURVEY_REPEATS):
        compute_impact_ratios(planned.trajectory, times, planned.setup)
    return (process_time() - began) / SURVEY_REPEATS


def _largest_shift(before: Plan, after: Plan) -> float:
    """Return the largest change [s] of a stroke's time between two plans.

    0 if the plans have no common stroke.
    """
    strokes = {(sync.behaviour, sync.sync): sync.planned for sync in before.syncs if sync.is_stroke}
    shifts = [abs(sync.planned - strokes.get((sync.behaviour, sync.sync), sync.planned)) for sync in after.syncs]
    return max(shifts, default=0.0)


def _count_dropped(planned: Plan) -> int:
    return sum(outcome.kind == "dropped" for outcome in planned.keyframes.outcomes.values())


def summarise_plans(prefix: str, compared: Sequence[ComparedPlan]) -> list[Metric]:
    """Return the metrics of compared plans."""
    ratios, stretches = (np.array([getattr(entry, name) for entry in compared]) for name in ("ratio", "stretch"))
    shifts = np.array([entry.shift for entry in compared])
    exceeding = [entry.name for entry in compared if entry.ratio > 1.0]
    exceeding_before = sum(entry.ratio_before > 1.0 for entry in compared)
    dropped = [entry.name for entry in compared if entry.dropped]
    before, after = (sum(entry.seconds[k] for entry in compared) for k in (0, 1))
    surveys = sum(entry.survey_seconds for entry in compared)
    return [
        Metric(f"{prefix}.plans", float(len(compared)), "plans", None, "higher"),
        Metric(f"{prefix}.over_without_policy", float(exceeding_before), "plans", None, "lower"),
        Metric(f"{prefix}.over", float(len(exceeding)), "plans", 0.0, "lower", "; ".join(exceeding[:3])),
        Metric(f"{prefix}.ratio_max", float(ratios.max()), "of limit", 1.0, "lower"),
        Metric(f"{prefix}.dropped", float(len(dropped)), "plans", None, "lower", "; ".join(dropped[:3])),
        Metric(f"{prefix}.shifted", float((shifts > SHIFT_TO_WARN).sum()), "plans", None, "lower"),
        Metric(f"{prefix}.shift_p95", float(np.percentile(shifts, 95.0)), "s", None, "lower"),
        Metric(f"{prefix}.stretch_p50", float(np.median(stretches)), "times", None, "lower"),
        Metric(f"{prefix}.stretch_max", float(stretches.max()), "times", None, "lower"),
        Metric(f"{prefix}.planning_time", after / before, "times", None, "lower", "CPU time with / without the policy"),
        Metric(f"{prefix}.survey_time", surveys / before, "of planning", MAX_SURVEY_RATIO, "lower"),
    ]
