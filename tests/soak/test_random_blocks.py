"""Random blocks of all gestures in extreme styles."""

import random
from dataclasses import replace

import pytest

from kinesic.bench.plan import count_violations, count_wrong_warnings
from kinesic.controller.dry_run import dry_run
from kinesic.expressivity.style.style import EXPRESSIVITY_RANGES, Expressivity, Style
from kinesic.report.checks import checks
from kinesic.session.plan import plan
from kinesic.session.setup import set_up

ROOT = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">{}</bml>'
MODES = ("LEFT_HAND", "RIGHT_HAND", "BOTH_HANDS")
BLOCK_COUNT = 100  # number of random blocks per seed

pytestmark = pytest.mark.soak


@pytest.fixture(scope="module")
def known():
    return set_up()


def random_style(chance: random.Random) -> Style:
    values = {name: chance.choice([low, (low + high) / 2, high]) for name, (low, high) in EXPRESSIVITY_RANGES.items()}
    return Style.uniform(Expressivity(**values), "random")


def random_block(chance: random.Random, lexemes: list[str]) -> str:
    lines = [
        f'<gesture id="g{k}" lexeme="{chance.choice(lexemes)}" mode="{chance.choice(MODES)}" '
        f'stroke="{chance.uniform(0, 8):.3f}"/>'
        for k in range(chance.randint(1, 6))
    ]
    lines += [
        f'<head id="h{k}" lexeme="{chance.choice(["NOD", "SHAKE"])}" amount="{chance.random():.2f}" '
        f'start="{chance.uniform(0, 6):.3f}"/>'
        for k in range(chance.randint(0, 2))
    ]
    if chance.random() < 0.5:
        lean = chance.choice(["LEANING_FORWARD", "LEANING_BACKWARD"])
        lines.append(f'<posture id="p" start="1" end="6"><pose part="WHOLEBODY" lexeme="{lean}"/></posture>')
    if chance.random() < 0.5:
        lines.append(
            f'<pointing id="q" target="{chance.choice(["left", "right"])}" stroke="{chance.uniform(0, 8):.3f}"/>'
        )
    return ROOT.format("".join(lines))


@pytest.mark.parametrize("seed", range(10))
def test_random_blocks_in_random_styles_pass_all_checks(seed, known):
    chance = random.Random(seed)
    lexemes = [form.id for form in known.lexicon.forms]
    for _ in range(BLOCK_COUNT):
        text, style = random_block(chance, lexemes), random_style(chance)
        performance = dry_run(plan(text, replace(known, style=style)))
        failed = [check for check in checks(performance) if check.status == "fail"]
        assert not failed, f"{failed}\n{text}\n{style}"
        assert count_violations(performance.plan) == 0, f"{text}\n{style}"
        assert count_wrong_warnings(performance.plan) == (0, 0), f"{text}\n{style}"
        outcomes = performance.plan.keyframes.outcomes
        assert all(outcome.why for outcome in outcomes.values() if outcome.kind == "dropped")
