from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from kinesic.bench import ik
from kinesic.bench.ik import ablation
from kinesic.bench.ik.ablation import (
    ABLATION_ROWS,
    USER_ENTRIES,
    AblationArm,
    ablation_name,
    guess_angles,
    settle_bone_ends,
)
from kinesic.bench.metric import Metric
from kinesic.body.robot import Robot
from kinesic.ik.arm.linkage import linkage_of
from kinesic.ik.scalar3 import distance

from ...reference.ik.hinges import extract


@pytest.fixture(scope="module")
def arm() -> AblationArm:
    chain = Robot.load().arms["l"]
    return AblationArm(chain, linkage_of(chain), tuple(chain.rest.tolist()))


@pytest.fixture(scope="module")
def metrics() -> list[Metric]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(ablation, "TARGET_COUNT", 80)
        return ablation.bench()


def test_every_ablation_row_has_metrics_without_goals(metrics: list[Metric]) -> None:
    names = {metric.name for metric in metrics}
    assert {ablation_name(row, quantity) for row in ABLATION_ROWS for quantity in ("mm", "tenth_mm", "travel")} <= names
    assert {metric.name for metric in metrics if metric.unit == "us"} == {
        ablation_name(row, "us") for row in USER_ENTRIES
    }
    assert {metric.goal for metric in metrics} == {None}
    assert len(names) == len(metrics)


def test_ik_success_rate_does_not_fall_with_added_solver_stages(metrics: list[Metric]) -> None:
    values = {metric.name: metric.value for metric in metrics}
    assert values[ablation_name("whole", "tenth_mm")] == values[ablation_name("polish_seeds", "tenth_mm")] == 1.0
    assert (
        values[ablation_name("masses_branches_polish_seeds", "mm")]
        >= values[ablation_name("masses_branches_polish", "mm")]
    )
    assert values[ablation_name("masses_branches_polish", "mm")] >= values[ablation_name("masses_branches", "mm")]
    assert all(values[ablation_name(row, "mm")] >= values[ablation_name(row, "tenth_mm")] for row in ABLATION_ROWS)


def test_same_ik_targets_give_the_same_ablation_metrics(metrics: list[Metric], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ablation, "TARGET_COUNT", 80)
    repeated = {metric.name: metric.value for metric in ablation.bench() if metric.unit != "us"}
    assert repeated == {metric.name: metric.value for metric in metrics if metric.unit != "us"}


def test_mass_spring_model_keeps_bone_lengths_and_puts_the_hand_on_the_target(arm: AblationArm) -> None:
    target = (0.2, 0.15, 0.05)
    ends = settle_bone_ends(arm, target)
    assert distance(ends[-1], target) < 1e-12
    assert distance(ends[-1], ends[-2]) == pytest.approx(arm.linkage.links[-2].length, abs=1e-5)
    assert distance(ends[-2], ends[-3]) == pytest.approx(arm.linkage.links[-3].length, abs=1e-5)


def test_greedy_ik_guess_stays_in_range_and_is_never_more_accurate_than_backtracking(arm: AblationArm) -> None:
    rng, chain = np.random.default_rng(2), arm.chain
    wrong = 0
    for _ in range(60):
        points = arm.linkage.walk(rng.uniform(chain.lower, chain.upper).tolist(), len(arm.linkage.links) - 1)[1][1:]
        angles = guess_angles(arm, points)
        assert all(p.lower <= q <= p.upper for p, q in zip(arm.linkage.pivots, angles, strict=False))
        errors = [distance(a, b) for a, b in zip(arm.linkage.walk(angles, len(points))[1][1:], points, strict=True)]
        assert sum(errors) >= extract(arm.linkage, points, arm.rest).miss - 1e-9
        wrong += sum(errors) > 1e-6
    assert wrong > 0


def test_plotted_ik_target_is_missed_by_the_mass_spring_model_and_reached_by_the_elbow_circle(arm: AblationArm) -> None:
    limited = extract(arm.linkage, settle_bone_ends(arm, ablation.DRAWN_TARGET), arm.rest)
    assert limited.miss > 0.01
    assert (
        distance(
            arm.linkage.hand(ABLATION_ROWS["circle"].answer(arm, np.array(ablation.DRAWN_TARGET))),
            ablation.DRAWN_TARGET,
        )
        < 1e-5
    )


@pytest.mark.soak
def test_ablation_plot_is_drawn_from_metrics_alone(metrics: list[Metric], tmp_path: Path) -> None:
    (path,) = ik.draw(metrics, tmp_path)
    with Image.open(path) as picture:
        shades = np.asarray(picture.convert("L"))
    assert shades.shape[1] > 1000
    assert 0.02 < (shades < 200).mean() < 0.5
