from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from kinesic.bench import ik
from kinesic.bench.figure import Figure
from kinesic.bench.ik import ablation
from kinesic.bench.ik.ablation import ENTRIES, ROWS, AblationArm, ablation_name, guessed, masses
from kinesic.body.robot import Robot
from kinesic.ik import KERNEL
from kinesic.ik.arm.hinges import extract
from kinesic.ik.arm.linkage import linkage_of
from kinesic.ik.scalar3 import distance


@pytest.fixture(scope="module")
def arm() -> AblationArm:
    chain = Robot.load().arms["l"]
    return AblationArm(chain, linkage_of(chain), tuple(chain.rest.tolist()))


@pytest.fixture(scope="module")
def figures() -> list[Figure]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(ablation, "TARGETS", {"compiled": 80, "numpy": 20})
        return ablation.bench()


def test_every_row_has_its_figures_and_no_goal(figures: list[Figure]) -> None:
    names = {figure.name for figure in figures}
    assert {ablation_name(row, quantity) for row in ROWS for quantity in ("mm", "tenth_mm", "travel")} <= names
    assert {figure.name for figure in figures if figure.unit == "us"} == (
        {ablation_name(row, "us") for row in ENTRIES} if KERNEL == "compiled" else set()
    )
    assert {figure.goal for figure in figures} == {None}
    assert len(names) == len(figures)


def test_shares_are_ordered_as_the_stages_are(figures: list[Figure]) -> None:
    share = {figure.name: figure.value for figure in figures}
    assert share[ablation_name("whole", "tenth_mm")] == share[ablation_name("polish_seeds", "tenth_mm")] == 1.0
    assert (
        share[ablation_name("masses_branches_polish_seeds", "mm")]
        >= share[ablation_name("masses_branches_polish", "mm")]
    )
    assert share[ablation_name("masses_branches_polish", "mm")] >= share[ablation_name("masses_branches", "mm")]
    assert all(share[ablation_name(row, "mm")] >= share[ablation_name(row, "tenth_mm")] for row in ROWS)


def test_the_same_targets_give_the_same_figures(figures: list[Figure], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ablation, "TARGETS", {"compiled": 80, "numpy": 20})
    again = {figure.name: figure.value for figure in ablation.bench() if figure.unit != "us"}
    assert again == {figure.name: figure.value for figure in figures if figure.unit != "us"}


def test_masses_keep_the_bones_and_end_on_the_target(arm: AblationArm) -> None:
    target = (0.2, 0.15, 0.05)
    ends = masses(arm, target)
    assert distance(ends[-1], target) < 1e-12
    assert distance(ends[-1], ends[-2]) == pytest.approx(arm.linkage.links[-2].length, abs=1e-5)
    assert distance(ends[-2], ends[-3]) == pytest.approx(arm.linkage.links[-3].length, abs=1e-5)


def test_a_guess_stays_in_range_and_is_never_better_than_all_branches(arm: AblationArm) -> None:
    chance, chain = np.random.default_rng(2), arm.chain
    wrong = 0
    for _ in range(60):
        points = arm.linkage.walk(chance.uniform(chain.lower, chain.upper).tolist(), len(arm.linkage.links) - 1)[1][1:]
        angles = guessed(arm, points)
        assert all(p.lower <= q <= p.upper for p, q in zip(arm.linkage.pivots, angles, strict=False))
        missed = [distance(a, b) for a, b in zip(arm.linkage.walk(angles, len(points))[1][1:], points, strict=True)]
        assert sum(missed) >= extract(arm.linkage, points, arm.rest).miss - 1e-9
        wrong += sum(missed) > 1e-6
    assert wrong > 0


def test_the_picture_shows_a_target_that_masses_alone_miss(arm: AblationArm) -> None:
    held = extract(arm.linkage, masses(arm, ablation.TARGET), arm.rest)
    assert held.miss > 0.01
    assert distance(arm.linkage.hand(ROWS["circle"].answer(arm, np.array(ablation.TARGET))), ablation.TARGET) < 1e-5


def test_the_picture_is_drawn_from_the_figures_alone(figures: list[Figure], tmp_path: Path) -> None:
    (path,) = ik.draw(figures, tmp_path)
    with Image.open(path) as picture:
        shades = np.asarray(picture.convert("L"))
    assert shades.shape[1] > 1000
    assert 0.02 < (shades < 200).mean() < 0.5
