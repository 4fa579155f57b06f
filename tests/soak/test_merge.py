"""Hundreds of blocks merged with a running motion, or replacing it."""

import random

import numpy as np
import pytest

from kinesic.bench.bml.merging import REPLACEMENT_COUNT, replace_at_random
from kinesic.bml.parse import parse
from kinesic.motion.limit_check import check_limits
from kinesic.motion.trajectory import stay
from kinesic.motion.transition import extend_controls, knot_at
from kinesic.planning.certify import compute_peak_duties
from kinesic.planning.clearance import LAG_RESERVE, scan_clearance
from kinesic.planning.plan import plan_block
from kinesic.planning.quick_plan import plan_quickly
from kinesic.realizer.merge import merge, replace_motion
from kinesic.realizer.occupancy import freed_hinges, remaining_occupancy
from kinesic.realizer.release import release_motion
from kinesic.session.setup import set_up

ROOT = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">{}</bml>'
MODES = ("LEFT_HAND", "RIGHT_HAND", "BOTH_HANDS")
BLOCK_COUNT = 60  # number of prepared random blocks
MERGE_COUNT = 400  # number of merges or replacements
KEPT_PAST = 0.1  # [s] duration of past motion that is kept

pytestmark = pytest.mark.soak


@pytest.fixture(scope="module")
def known():
    return set_up()


def random_block(chance: random.Random, lexemes: list[str]) -> str:
    """Return a block of one behaviour or three."""
    lexeme, mode, side = chance.choice(lexemes), chance.choice(MODES), chance.choice(("left", "right"))
    gesture = f'<gesture id="g" lexeme="{lexeme}" mode="{mode}"/>'
    kinds = [
        f'<head id="h" lexeme="NOD" amount="{chance.random():.2f}" repetition="{chance.randint(1, 3)}"/>',
        f'<head id="h" lexeme="SHAKE" amount="{chance.random():.2f}"/>',
        gesture,
        gesture,
        gesture,
        f'<gaze id="z" target="{side}" start="0" end="{chance.uniform(1, 4):.2f}"/>',
        f'<pointing id="p" target="{side}"/>',
        f'<gazeShift id="z" target="{side}"/>',
        f'<headDirectionShift id="z" target="{side}"/>',
        '<posture id="l" start="0" end="3"><pose part="WHOLEBODY" lexeme="LEANING_FORWARD"/></posture>',
        f'<gesture id="g" lexeme="{lexeme}" mode="{mode}" stroke="0.9"/><head id="h" lexeme="NOD" start="1"/>'
        f'<gesture id="k" lexeme="{chance.choice(lexemes)}" mode="{mode}" stroke="2.5"/>',
    ]
    return ROOT.format(chance.choice(kinds))


@pytest.mark.parametrize("seed", range(4))
def test_merged_stream_of_blocks_keeps_limits_and_clearance(seed, known):
    chance = random.Random(seed)
    lexemes = [form.id for form in known.lexicon.forms]
    planner = plan_quickly if seed % 2 else plan_block
    pool = [planner(parse(random_block(chance, lexemes)), known) for _ in range(BLOCK_COUNT)]
    motion, now, playing = stay(known.robot.skeleton.rest), 0.0, []
    least = known.robot.min_clearance + LAG_RESERVE
    for step in range(MERGE_COUNT):
        now += chance.expovariate(1 / 0.6)
        motion = motion.since(now - KEPT_PAST)
        playing = [item.since(now - KEPT_PAST) for item in playing]
        playing = [item for item in playing if any(need.end > now or need.is_held for need in item.occupancy)]
        needs = remaining_occupancy((need for item in playing for need in item.occupancy), now)
        deed = chance.random()
        if deed < 0.85:
            merged = merge(motion, now, chance.choice(pool), begin=now, occupied=needs)
            after, playing = merged.trajectory, [*playing, merged]
        elif deed < 0.93:
            merged = replace_motion(motion, now, chance.choice(pool))
            after, playing = merged.trajectory, [merged]
        elif playing:
            gone = playing.pop(chance.randrange(len(playing)))
            others = [need for item in playing for need in item.occupancy]
            free = freed_hinges(
                gone.occupancy, np.ptp(gone.layer.controls, axis=0) > 0.0, now, known.robot, others=others
            )
            after = release_motion(motion, now, free, known, layer=gone.layer, others=others)
        else:
            continue
        count = knot_at(now - motion.start) + 3
        same = [extend_controls(item.controls, count)[:count] for item in (motion, after)]
        np.testing.assert_allclose(*same, atol=1e-8, err_msg=f"step {step}")
        for name, peak in check_limits(after, known.limits).by_quantity.items():
            assert peak.ratios.max() <= 1.001, (step, name)
        assert compute_peak_duties(after, known).max() <= 1.0, step
        assert scan_clearance(after, known.distances)[1].distances.min() >= least - 1e-4, step
        assert len(after.controls) < 2500, step
        motion = after


def test_motion_replaced_at_random_times_keeps_joint_limits_without_collision(known):
    result = replace_at_random(known, REPLACEMENT_COUNT, seed=1)
    worst = max(result, key=lambda cut: cut.ratio)
    assert worst.ratio <= 1.001, worst
    assert max(cut.step for cut in result) <= 1e-8
    assert min(cut.clearance for cut in result) >= 0.0
    assert sum(cut.dropped for cut in result) == 0
