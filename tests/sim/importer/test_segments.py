import numpy as np
import pytest

from kinesic.sim.importer.hinges import named_hinges
from kinesic.sim.importer.segments import lay_out_segments


def test_segments_begin_at_the_centres(tee_figure):
    where = lay_out_segments(tee_figure, named_hinges(tee_figure))
    left = tee_figure.arms["l"].centres
    assert where.carrier == "vl5"
    assert where.parents["l_shoulder"] == "l_acromioclavicular"
    assert where.origins["l_elbow"] == pytest.approx(left.elbow)
    assert where.origins["skullbase"] == pytest.approx([0, 0, 1.55], abs=1e-3)
    assert where.inside("l_elbow", left.elbow) == pytest.approx(np.zeros(3))


def test_nothing_above_the_pelvis_loses_weight(tee_mapped):
    mass = {body.name: body.mass for body in tee_mapped.file.body}
    assert mass["humanoid_root"] == pytest.approx(4.0)
    assert mass["vl5"] == pytest.approx(8.0)
    assert mass["skullbase"] == pytest.approx(2.0)
    arm = [mass[f"l_{part}"] for part in ("acromioclavicular", "shoulder", "elbow", "wrist")]
    assert arm == pytest.approx([0.0, 1.2, 0.8, 0.3], abs=0.02)


def test_own_shapes_are_taken_and_missing_ones_made(tee_mapped, hanging_mapped):
    own, made = ({body.name: body.capsules for body in found.file.body} for found in (tee_mapped, hanging_mapped))
    assert own["l_shoulder"][0].radius == 0.035
    assert made["l_shoulder"][0].radius == pytest.approx(0.15 * 0.28, rel=0.01)
