"""Generated segment shapes and hinge names, signs and ranges of synthetic geometry."""

from math import pi, radians
from types import SimpleNamespace

import numpy as np
import pytest

from kinesic.body.skeleton import Capsule
from kinesic.sim.importer import hinges
from kinesic.sim.importer.hinges import (
    _choose_suffixes,
    _find_axis_sign,
    _find_default_range,
    _find_elbow_sign,
    _make_distinct,
    _map_hinge,
    _spine,
    spell_angle,
)
from kinesic.sim.importer.model_tree import BASE_INDEX, ModelPart
from kinesic.sim.importer.segments import (
    SegmentLayout,
    _generate_capsules,
    assign_parts,
    convert_capsules,
    housing,
    lay_out_segments,
    make_bone_capsule,
    make_trunk_capsules,
    round_triple,
)

X, Y, Z = np.eye(3)
SHOULDER = np.array([0.02, 0.2, 1.4])
ARM = SimpleNamespace(
    centres=SimpleNamespace(
        shoulder=SHOULDER,
        elbow=SHOULDER - 0.3 * Z,
        wrist=SHOULDER - 0.5 * Z,
        upper=-Z,
        fore=-Z,
        lengths=(0.3, 0.2),
    ),
    joints=(2, 3, 4),
)

RIGHT_ARM = SimpleNamespace(centres=ARM.centres, joints=(12, 13, 14))


def figure(*, neck=(), trunk=(), girdle=0, tree=None):
    split = SimpleNamespace(girdle=girdle, elbow=girdle + 2)
    return SimpleNamespace(
        arms={"l": ARM, "r": RIGHT_ARM}, arm_length=0.5, neck=neck, trunk=trunk, split=split, tree=tree
    )


def spans(capsules):
    return [(capsule.start, capsule.end, capsule.radius) for capsule in capsules]


def close(capsules, expected):
    assert len(capsules) == len(expected)
    for capsule, (start, end, radius) in zip(capsules, expected, strict=True):
        np.testing.assert_allclose([*capsule.start, *capsule.end, capsule.radius], [*start, *end, radius], atol=1.1e-6)


def test_coordinates_of_imported_shapes_are_rounded_to_micrometres():
    assert round_triple(np.array([0.12345649, -1e-9, -0.00000051])) == (0.123456, 0.0, -0.000001)


def test_bone_capsule_has_a_radius_of_at_least_1_cm():
    close([make_bone_capsule(X, 3 * X, 0.0099, free_fraction=0.25)], [((1.5, 0, 0), (3, 0, 0), 0.01)])
    close([make_bone_capsule(X, 3 * X, 0.02)], [((1, 0, 0), (3, 0, 0), 0.02)])


def test_shapes_keep_their_radius_in_the_frame_of_the_segment():
    close(convert_capsules([Capsule(2 * X, 3 * X, 0.0123456789)], X), [((1, 0, 0), (2, 0, 0), 0.012346)])


def test_tall_trunk_gets_chest_and_belly_capsules_and_a_low_one_a_chest_capsule_only():
    radius = 0.62 * (0.2 - 0.045 - 0.035)
    side = 0.12 - radius
    chest = ((0, -side, 0.5 - 0.8 * radius), (0, side, 0.5 - 0.8 * radius), radius)
    belly = ((0, 0, radius), (0, 0, (radius + 0.5 - 0.8 * radius) / 2), 0.9 * radius)
    close(make_trunk_capsules(np.zeros(3), 0.5 * Z, 0.2, 0.045), [chest, belly])
    for height, count in ((2.29 * radius, 1), (2.31 * radius, 2)):
        assert len(make_trunk_capsules(np.zeros(3), height * Z, 0.2, 0.045)) == count
    assert make_trunk_capsules(np.zeros(3), Z, 0.05, 0.045)[0].radius == 0.01


def layout(*extra, carrier_is_trunk=False):
    origins = {
        "humanoid_root": np.array([0.02, 0.0, 0.95]),
        "vl5": np.array([0.0, 0.0, 1.0]),
        "skullbase": np.array([0.0, 0.0, 1.5]),
        "l_acromioclavicular": SHOULDER - 0.1 * Y,
        "l_shoulder": SHOULDER,
        "l_elbow": SHOULDER - 0.3 * Z,
        "l_wrist": SHOULDER - 0.5 * Z,
    }
    parents = {name: "world" for name in origins if name != "vl5" or carrier_is_trunk}
    return SegmentLayout(parents, origins)


@pytest.mark.parametrize(
    ("name", "capsule"),
    [
        ("l_shoulder", ((0, 0, -0.06), (0, 0, -0.3), 0.045)),
        ("l_elbow", ((0, 0, 0), (0, 0, -0.2), 0.028)),
        ("l_wrist", ((0, 0, -0.027), (0, 0, -0.09), 0.024)),
        ("l_acromioclavicular", ((0, 0, 0), (0, 0.1, 0), 0.045)),
        ("skullbase", ((0.1, 0, 0.1 - 0.017), (0.1, 0, 0.1 + 0.017), 0.085)),
        ("humanoid_root", ((0, -0.02, 0), (0, 0.02, 0), 0.08)),
    ],
)
def test_segment_without_shapes_gets_a_capsule_of_human_proportions(name, capsule):
    part = SimpleNamespace(centre=np.array([0.1, 0.0, 1.6]))
    tree = SimpleNamespace(below=lambda k: (k,), merge_parts=lambda parts: ModelPart(0.0, 0 * X, ()))
    close(_generate_capsules(figure(neck=(1,), tree=tree), layout(carrier_is_trunk=True), name, part), [capsule])


def test_head_without_hinges_becomes_a_capsule_above_the_shoulders_of_the_trunk():
    trunk = _generate_capsules(figure(), layout(), "humanoid_root", None)
    close(trunk[-1:], [((0, 0, 0.45 + 0.075), (0, 0, 0.45 + 0.225), 0.07)])
    with_neck = _generate_capsules(figure(neck=(1,)), layout(), "humanoid_root", None)
    assert spans(with_neck) == spans(trunk[:-1])
    expected = make_trunk_capsules(np.zeros(3), np.array([0, 0, 0.45]), 0.2, 0.045)
    assert spans(with_neck) == spans(expected)


@pytest.mark.parametrize(("girdle", "name"), [(0, "l_acromioclavicular"), (1, "l_sternoclavicular")])
def test_shoulder_is_carried_by_a_fixed_housing_or_a_moving_collar_bone(girdle, name):
    assert housing(figure(girdle=girdle), "l") == name


def test_trunk_without_hinges_ends_0_9_arm_lengths_below_the_shoulders():
    found = lay_out_segments(figure(), ())
    assert found.carrier == "humanoid_root"
    assert list(found.parents.items())[:5] == [
        ("humanoid_root", "world"),
        ("l_acromioclavicular", "humanoid_root"),
        ("l_shoulder", "l_acromioclavicular"),
        ("l_elbow", "l_shoulder"),
        ("l_wrist", "l_elbow"),
    ]
    np.testing.assert_allclose(found.origins["humanoid_root"], (0.02, 0.0, 0.95))
    np.testing.assert_allclose(found.origins["l_acromioclavicular"], SHOULDER)
    np.testing.assert_allclose(found.inside("l_elbow", SHOULDER), 0.3 * Z)


def test_trunk_and_head_begin_at_the_common_points_of_their_hinges():
    rows = (
        SimpleNamespace(segment="vl5", anchor=np.array([0.0, 0.0, 1.0]), axis=X),
        SimpleNamespace(segment="vl5", anchor=np.array([0.0, 0.0, 1.0]), axis=Z),
        SimpleNamespace(segment="skullbase", anchor=np.array([0.0, 0.0, 1.5]), axis=Y),
        SimpleNamespace(segment="skullbase", anchor=np.array([0.0, 0.0, 1.6]), axis=Z),
    )
    found = lay_out_segments(figure(neck=(2, 3), trunk=(0, 1)), rows)
    assert (found.carrier, found.parents["vl5"], found.parents["skullbase"]) == ("vl5", "humanoid_root", "vl5")
    assert found.parents["r_acromioclavicular"] == "vl5"
    np.testing.assert_allclose(found.origins["vl5"], (0, 0, 1), atol=1e-3)
    np.testing.assert_allclose(found.origins["humanoid_root"], (0, 0, 1), atol=1e-3)
    np.testing.assert_allclose(found.origins["skullbase"], (0, 0, 1.5), atol=1e-3)


@pytest.mark.parametrize(
    ("distance", "segment"), [(0.0, "l_acromioclavicular"), (0.07, "l_acromioclavicular"), (0.08, "l_shoulder")]
)
def test_part_after_the_first_shoulder_hinge_is_upper_arm_beyond_a_quarter_of_it(distance, segment):
    part = ModelPart(1.0, SHOULDER - distance * Z, ())
    tree = SimpleNamespace(joints=range(4), path_from_base=lambda k: tuple(range(k + 1)), merge_parts=lambda _: part)
    shoulder_hinges = tuple(SimpleNamespace(joint=joint, segment="l_shoulder") for joint in (2, 3))
    found = assign_parts(figure(tree=tree), layout(carrier_is_trunk=True), shoulder_hinges)
    assert 2 in found[segment]


def test_model_parts_belong_to_the_last_segment_on_their_path_and_legs_to_none():
    paths = {0: (0,), 1: (1,), 2: (1, 2), 3: (1, 2, 3), 4: (1, 2, 3, 4), 5: (1, 5), 6: (0, 6)}
    part = ModelPart(1.0, SHOULDER, ())
    tree = SimpleNamespace(joints=range(7), path_from_base=lambda k: paths[k], merge_parts=lambda _: part)
    moved = [
        SimpleNamespace(joint=joint, segment=segment)
        for joint, segment in ((1, "vl5"), (3, "l_shoulder"), (4, "l_elbow"))
    ]
    found = assign_parts(figure(tree=tree, trunk=(1,)), layout(carrier_is_trunk=True), tuple(moved))
    assert found["vl5"] == [1, 5]
    assert (found["l_shoulder"], found["l_elbow"]) == ([3], [4])
    assert found["l_acromioclavicular"] == [2]
    assert found["humanoid_root"] == [BASE_INDEX]


def test_repeated_hinge_names_are_numbered():
    assert _make_distinct(["a", "b", "a", "a", "b"]) == ["a", "b", "a2", "a3", "b2"]


@pytest.mark.parametrize(
    ("part", "axes", "suffixes"),
    [
        ("sternoclavicular", (X, Z, X + Z), ["abduct", "rotate", "abduct2"]),
        ("elbow", (Y,), ["flexion"]),
        ("elbow", (Y, Z), ["flexion", "twisting"]),
        ("shoulder", (Y, X, Z), ["flexion", "abduct", "twisting"]),
        ("shoulder", (X, Y), ["abduct", "flexion"]),
        ("wrist", (Y, X), ["pivot", "flexion"]),
        ("wrist", (Z, X), ["twisting", "flexion"]),
        ("wrist", (), []),
    ],
)
def test_hinges_of_an_arm_are_named_by_their_axes(part, axes, suffixes):
    assert _choose_suffixes(part, [np.asarray(axis) / np.linalg.norm(axis) for axis in axes], -Z) == suffixes


@pytest.mark.parametrize(
    ("name", "axis", "left", "right"),
    [
        ("shoulder_flexion", -Y, 1, 1),
        ("shoulder_abduct", X, 1, -1),
        ("shoulder_twisting", Z, 1, -1),
        ("elbow_flexion", Z, 1, -1),
        ("elbow_flexion", -X, 1, -1),
        ("wrist_flexion", -X, 1, -1),
        ("wrist_pivot", Y, 1, 1),
        ("wrist_flexion", -Y, 1, 1),
    ],
)
def test_positive_directions_of_left_and_right_hinges_are_mirrored(name, axis, left, right):
    assert (_find_axis_sign(name, axis, "l"), _find_axis_sign(name, axis, "r")) == (left, right)
    assert _find_axis_sign(name, -axis, "l") == -left


@pytest.mark.parametrize(
    ("name", "degrees"),
    [
        ("vl5_torsion", (-60, 60)),
        ("skullbase_tilt", (-20, 35)),
        ("vl5_roll", (-25, 25)),
        ("l_sternoclavicular_abduct", (-10, 25)),
        ("l_sternoclavicular_rotate", (-20, 20)),
        ("l_sternoclavicular_twisting", (-20, 20)),
        ("l_shoulder_flexion", (-60, 170)),
        ("l_shoulder_abduct2", (-20, 120)),
        ("r_shoulder_twisting", (-90, 90)),
        ("l_elbow_flexion", (0, 135)),
        ("l_elbow_twisting", (-90, 90)),
        ("l_wrist_flexion", (-60, 60)),
        ("l_wrist_pivot", (-30, 30)),
        ("l_wrist_twisting", (-90, 90)),
    ],
)
def test_imported_hinge_without_a_range_gets_the_human_range(name, degrees):
    assert _find_default_range(name) == pytest.approx(np.radians(degrees))


@pytest.mark.parametrize(
    ("lower", "upper", "zero", "sign", "expected"),
    [
        (-1.0, 2.0, 0.5, 1.0, (-1.5, 1.5, False, 0.5)),
        (-1.0, 2.0, 0.5, -1.0, (-1.5, 1.5, False, 0.5)),
        (0.0, 1.0, 0.25, -1.0, (-0.75, 0.25, False, 0.25)),
        (-4.0, 1.0, 0.0, 1.0, (-pi, 1.0, False, 0.0)),
        (-1.0, 4.0, 0.0, 1.0, (-1.0, pi, False, 0.0)),
        (5.0, 7.0, 0.0, 1.0, (5.0 - 2 * pi, 7.0 - 2 * pi, False, 2 * pi)),
        (None, 1.0, 0.5, 1.0, (0.0, radians(135), True, 0.5)),
        (-1.0, None, 0.5, 1.0, (0.0, radians(135), True, 0.5)),
        (0.0, radians(350), 0.5, 1.0, (0.0, radians(135), True, 0.5)),
    ],
)
def test_range_of_a_hinge_is_relative_to_its_zero_within_half_a_turn(lower, upper, zero, sign, expected):
    foreign = SimpleNamespace(lower=lower, upper=upper, zero=zero, anchor=X, axis=Y)
    shape = SimpleNamespace(tree=SimpleNamespace(joints={7: foreign}))
    mapped = _map_hinge(shape, 7, "l_elbow_flexion", "l_elbow", sign)
    assert (mapped.lower, mapped.upper, mapped.assumed, mapped.zero) == pytest.approx(expected)
    assert (mapped.name, mapped.segment, mapped.joint, mapped.sign) == ("l_elbow_flexion", "l_elbow", 7, sign)
    assert (mapped.anchor.tolist(), mapped.axis.tolist()) == (X.tolist(), (sign * Y).tolist())


@pytest.mark.parametrize(
    ("lower", "upper", "asked"), [(0.25, 2.0, (-0.25, 1.5)), (None, 2.0, (-np.inf, 1.5)), (0.25, None, (-0.25, np.inf))]
)
def test_elbow_sign_is_found_from_its_range_relative_to_its_zero(monkeypatch, lower, upper, asked):
    calls = []
    monkeypatch.setattr(hinges, "find_elbow_sense", lambda *arguments: calls.append(arguments) or -1.0)
    elbow = SimpleNamespace(lower=lower, upper=upper, zero=0.5)
    shape = SimpleNamespace(
        tree=SimpleNamespace(joints={7: elbow}), arms={"l": SimpleNamespace(limb="limb")}, split="split"
    )
    assert _find_elbow_sign(shape, "l", 7) == -1.0
    assert calls == [("limb", "split", *asked)]


def test_hinges_of_the_spine_are_named_from_the_base_upwards_by_their_nearest_axes():
    axes = (Z, -X, Y, -Z, Y)
    joints = [SimpleNamespace(axis=axis + 0.1, anchor=X, zero=0.0, lower=None, upper=None) for axis in axes]
    shape = SimpleNamespace(tree=SimpleNamespace(joints=joints))
    trunk = list(_spine(shape, "vl5", range(4)))
    assert [(hinge.name, hinge.sign) for hinge in trunk] == [
        ("vl5_torsion", 1.0),
        ("vl5_roll", -1.0),
        ("vl5_tilt", 1.0),
        ("vt10_torsion", -1.0),
    ]
    assert [hinge.name for hinge in _spine(shape, "skullbase", (2, 4))] == ["vc4_tilt", "skullbase_tilt"]


@pytest.mark.parametrize(("sign", "text"), [(1.0, "j = angle +90.0000 deg"), (-1.0, "j = -angle +90.0000 deg")])
def test_joint_angle_of_the_file_is_written_as_a_formula_of_the_hinge_angle(sign, text):
    assert spell_angle(SimpleNamespace(sign=sign, zero=pi / 2), "j") == text
