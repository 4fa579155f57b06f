import numpy as np
import pytest

from kinesic.body.rotation import rotation_about
from kinesic.capture.reading.reachy_move import read_reachy_move
from kinesic.capture.reading.text import CaptureError

from ..clips import reachy_move

NOD = [rotation_about(np.array([0.0, 1.0, 0.0]), angle) for angle in (0.0, 0.1, 0.2, 0.1)]


def test_reachy_nod_becomes_a_pitch_of_the_head_from_time_zero():
    clip = read_reachy_move(reachy_move(NOD), "a.json")
    assert clip.times == pytest.approx([0, 0.01, 0.02, 0.03])
    assert clip.head == pytest.approx(np.outer([0, 0.1, 0.2, 0.1], [0, 1, 0]))
    assert clip.arms == {}


def test_body_yaw_of_a_reachy_move_is_subtracted_from_the_head():
    yaw = rotation_about(np.array([0.0, 0.0, 1.0]), 0.4)
    clip = read_reachy_move(reachy_move([yaw @ rotation for rotation in NOD], body_yaw=0.4), "a.json")
    assert clip.head == pytest.approx(np.outer([0, 0.1, 0.2, 0.1], [0, 1, 0]), abs=1e-9)


def test_reachy_setpoints_without_a_head_pose_are_skipped_and_counted():
    clip = read_reachy_move(reachy_move([NOD[0], None, *NOD[1:]]), "a.json")
    assert len(clip.times) == 4
    assert "1 setpoints" in clip.guesses[1]


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b"{}", "missing required field"),
        (b'{"time": [0, 1], "set_target_data": []}', "2 times and 0 setpoints"),
        (reachy_move([2 * rotation for rotation in NOD]), r"set_target_data\[0\]: head is no rotation"),
        (reachy_move(NOD, times=[0, 2, 1, 3]), "order of time"),
        (reachy_move([None, None]), "0 frames"),
        (b'{"time": [0, 1], "set_target_data": [{"head": [1, 2]}, {"head": [1]}]}', "2 numbers"),
    ],
)
def test_invalid_reachy_move_is_rejected(data, message):
    with pytest.raises(CaptureError, match=message):
        read_reachy_move(data, "a.json")
