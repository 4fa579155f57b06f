import numpy as np
import pytest

from kinesic.sim.importer.model_tree import BASE


def index(tree, name):
    return [joint.name for joint in tree.joints].index(name)


def test_way_below_and_children(tee):
    hand = index(tee, "l_wag")
    assert [tee.joints[k].name for k in tee.way(hand)][:3] == ["waist", "bow", "l_pitch"]
    assert {tee.joints[k].name for k in tee.below(hand)} == {"l_wag", "l_thumb", "l_finger"}
    assert tee.joints[tee.children[BASE][0]].name == "waist"


def test_a_lump_weighs_what_its_parts_weigh(tee):
    rows = [index(tee, "l_twist"), index(tee, "r_twist")]
    both = tee.lump(rows)
    assert both.mass == pytest.approx(2.4)
    assert both.centre[1] == pytest.approx(0.0, abs=1e-9)
    assert len(both.shapes) == 2


def test_turning_a_hinge_moves_what_hangs_on_it_and_nothing_else(tee):
    roll, bend = index(tee, "l_roll"), index(tee, "l_bend")
    turned = tee.turned({roll: -np.pi / 2})
    assert turned.joints[roll].zero == pytest.approx(-np.pi / 2)
    assert turned.joints[roll].anchor == pytest.approx(tee.joints[roll].anchor)
    assert turned.joints[bend].anchor - turned.joints[roll].anchor == pytest.approx([0.01, 0, -0.28])
    other = index(tee, "r_bend")
    assert turned.joints[other].anchor == pytest.approx(tee.joints[other].anchor)


def test_moving_keeps_distances(tee):
    moved = tee.moved(np.array([[0.0, 1, 0], [-1, 0, 0], [0, 0, 1]]), np.array([1.0, 2, 3]))
    before, after = (np.array([joint.anchor for joint in tree.joints]) for tree in (tee, moved))
    assert np.linalg.norm(np.diff(after, axis=0), axis=1) == pytest.approx(
        np.linalg.norm(np.diff(before, axis=0), axis=1)
    )
