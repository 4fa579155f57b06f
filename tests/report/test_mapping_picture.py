"""Picture of the joint mapping of an imported robot."""

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from kinesic.body.robot import Robot
from kinesic.report.mapping_picture import LABEL_PITCH, draw_mapping, place_labels, spread_labels
from kinesic.report.silhouette import project

JOINT_OF = [
    ("skullbase_torsion", "neck_yaw"),
    ("l_shoulder_flexion", "left_pitch"),
    ("l_elbow_flexion", "left_elbow"),
    ("r_elbow_flexion", "right_$elbow$\n" + 40 * "x"),
]


def test_labels_of_each_arm_stand_at_its_side_of_the_front_view():
    robot = Robot.load("upper22")
    left, right = place_labels(robot, JOINT_OF)
    assert [label.hinge for label in left] == ["skullbase_torsion", "r_elbow_flexion"], (
        "the neck fills the short column"
    )
    assert [label.joint for label in right] == ["left_pitch", "left_elbow"]
    elbow = robot.skeleton.rest_frames.origins[robot.skeleton.segment("l_elbow")]
    assert np.allclose(right[1].point, project(elbow), atol=1e-9)
    assert right[1].point[0] > 0 > left[1].point[0]


def test_mapping_labels_never_overlap_and_stay_within_the_column():
    heights = spread_labels([4.0, 3.99, 3.99, 3.99, 1.0, 0.05], 4.0, 0.1)
    assert all(upper - lower >= LABEL_PITCH - 1e-9 for upper, lower in pairwise(heights))
    assert max(heights) <= 4.0
    assert min(heights) >= 0.1
    assert heights[4] == 1.0, "a label with free space stands at the height of its hinge"
    assert spread_labels([2.0, 2.0], 4.0, 0.0) == pytest.approx([2.0 + LABEL_PITCH / 2, 2.0 - LABEL_PITCH / 2])


def test_mapping_picture_contains_printable_joint_names_and_the_confidence(tmp_path: Path, monkeypatch):
    figure = pytest.importorskip("matplotlib.figure").Figure
    papers: list = []
    save = figure.savefig

    def record(paper, *places, **options) -> None:
        papers.append(paper)
        save(paper, *places, **options)

    monkeypatch.setattr(figure, "savefig", record)
    path = tmp_path / "mapping.png"
    draw_mapping(Robot.load("upper22"), JOINT_OF, path, confidence=0.41, doubtful=True)
    assert path.read_bytes().startswith(b"\x89PNG")
    texts = [text.get_text() for text in papers[0].axes[0].texts]
    assert "upper22: confidence of the joint mapping 0.41 of 1, review it" in texts
    assert {"left_elbow", "l_elbow_flexion", "right_$elbow$?" + 15 * "x" + "..."} <= set(texts)


def test_mapping_picture_of_a_one_armed_robot_omits_the_other_arm(tmp_path: Path, monkeypatch):
    collections = pytest.importorskip("matplotlib.collections")
    line_counts: list[int] = []
    create = collections.LineCollection

    def record(lines, **options):
        line_counts.append(len(lines))
        return create(lines, **options)

    monkeypatch.setattr(collections, "LineCollection", record)
    for joint_of in (JOINT_OF, JOINT_OF[:3]):
        draw_mapping(Robot.load("upper22"), joint_of, tmp_path / "mapping.png", confidence=1.0, doubtful=False)
    assert line_counts[1] < line_counts[0]
