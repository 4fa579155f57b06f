import os
from pathlib import Path

import numpy as np
import pytest

from kinesic.body.config import ConfigError
from kinesic.expressivity.lexicon.gestuary import is_enabled, read_gestuary
from kinesic.expressivity.lexicon.lexicon import Lexicon

REPOSITORY_ROOT = Path(__file__).resolve().parents[3]
CORPUS_FOLDER = (
    Path(os.environ.get("KINESIC_CORPUS", REPOSITORY_ROOT.parent / "shared" / "corpus")) / "greta" / "lexicon"
)

HAND_TEMPLATE = """
<hand side="{side}" openness="1.13">
  <uniformPosition>
    <horizontalLocation value="0.3" fixed="true"/><verticalLocation value="0.2"/><frontalLocation value="0.5"/>
  </uniformPosition>
  <handShape value="{shape}"/>
  <wristOrientation global="{world}" w="{w}" x="{x}" y="{y}" z="{z}"/>
</hand>"""


def hand(side="LEFT", shape="FORM_OPEN", world="true", w=1.0, x=0.0, y=0.0, z=0.0):
    return HAND_TEMPLATE.format(side=side, shape=shape, world=world, w=w, x=x, y=y, z=z)


@pytest.fixture
def read(tmp_path):
    def from_phases(*phases, category="deictic"):
        path = tmp_path / "own.xml"
        inside = "".join(f"<phase>{phase}</phase>" for phase in phases)
        path.write_text(f'<gestuary><gesture category="{category}" id="Own">{inside}</gesture></gestuary>')
        return read_gestuary(path)[0]

    return from_phases


def test_gestuary_positions_are_reordered_to_kinesic_axes(read):
    pose = read(hand()).keys[0].hands["l"]
    assert pose.position == pytest.approx([0.5, 0.3, 0.2])
    assert pose.fixed == (False, True, False)
    assert pose.openness == 1.0
    assert pose.shape == "form_open"


@pytest.mark.parametrize(("side", "own"), [("LEFT", "l"), ("RIGHT", "r")])
def test_identity_quaternion_of_a_gestuary_gives_a_hanging_hand(read, side, own):
    pose = read(hand(side)).keys[0].hands[own]
    assert pose.pointing == pytest.approx([0, 0, -1])
    assert pose.palm == pytest.approx([0, -1, 0])


def test_gestuary_rotation_about_the_lateral_axis_points_the_hand_forward(read):
    half = np.sqrt(0.5)
    pose = read(hand(w=half, x=-half)).keys[0].hands["l"]
    assert pose.pointing == pytest.approx([1, 0, 0])
    assert pose.palm == pytest.approx([0, -1, 0])


def test_forearm_relative_rotation_in_a_gestuary_gives_only_a_palm_direction_to_a_straight_hand(read):
    half = np.sqrt(0.5)
    pose = read(hand(world="false", w=half, y=-half)).keys[0].hands["l"]
    assert pose.pointing is None
    assert pose.palm is not None
    assert pose.palm[2] < -0.7  # a quarter turn about the forearm: palm down


def test_mirrored_gestuary_quaternions_give_mirrored_hand_directions(read):
    for world in ("true", "false"):
        left, right = hand("LEFT", "X", world, 0.5, 0.3, 0.6, -0.4), hand("RIGHT", "X", world, 0.5, 0.3, -0.6, 0.4)
        hands = read(left + right).keys[0].hands
        assert hands["l"].palm == pytest.approx(hands["r"].palm)
        assert hands["l"].pointing == pytest.approx(hands["r"].pointing)


def test_gestuary_phase_inherits_unspecified_values(read):
    later = '<hand side="LEFT"><handShape value="EMPTY"/></hand>'
    first, second = (key.hands["l"] for key in read(hand(), later).keys)
    assert second.position == pytest.approx(first.position)
    assert second.palm == pytest.approx(first.palm)
    assert second.shape == first.shape


def test_gestuary_touch_point_lies_on_the_side_named_by_its_suffix(read):
    places = [
        read(f'<hand side="{side}"><touchPosition value="chin{end}"/></hand>').keys[0].hands[own].position
        for side, own, end in (("LEFT", "l", ""), ("LEFT", "l", "_L"), ("RIGHT", "r", "_L"))
    ]
    assert places[0] == pytest.approx(places[1])
    assert places[2] == pytest.approx(places[1] * [1, -1, 1])


def test_disabled_or_empty_gestuary_gestures_are_skipped(read):
    assert is_enabled(read(hand()))
    assert not is_enabled(read(hand(), category="zziconic"))
    assert not is_enabled(read())
    assert read(hand(), category="REST").rest


@pytest.mark.parametrize(
    ("phase", "message"),
    [
        ('<hand side="MIDDLE"/>', r"own\.xml:1: <hand> side is 'middle', must be LEFT or RIGHT"),
        ("<hand/>", r"<hand> has no side"),
        (hand().replace('"0.3"', '"far"'), r"own\.xml:4: <horizontalLocation> value is 'far', not a number"),
        (hand().replace('"0.3"', '"nan"'), r"must be a finite number"),
        (hand().replace('fixed="true"', 'fixed="maybe"'), r"fixed is 'maybe'; known: 0, 1, false, true"),
        (hand().replace("uniform", "symbolic"), r"0.3 is no sector of x; known: XEP"),
        (
            '<hand side="LEFT"><symbolicPosition><horizontalLocation value="XC"/></symbolicPosition></hand>',
            "has no <vert",
        ),
        ('<hand side="LEFT"><touchPosition value="chinn"/></hand>', r"no touch point; did you mean chin\?"),
    ],
)
def test_invalid_gestuary_gesture_error_has_file_and_line(read, phase, message):
    with pytest.raises(ConfigError, match=message):
        read(phase)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("<bml/>", r"root is <bml>, a gestuary begins with <gestuary>"),
        ("<gestuary>", r"x\.xml:1"),
        ('<!DOCTYPE g [<!ENTITY e "x">]><gestuary/>', "entity"),
    ],
)
def test_xml_document_that_is_no_gestuary_is_refused(tmp_path, text, message):
    (tmp_path / "x.xml").write_text(text)
    with pytest.raises(ConfigError, match=message):
        read_gestuary(tmp_path / "x.xml")


def test_error_names_a_missing_gestuary_file(tmp_path):
    with pytest.raises(ConfigError, match=r"none\.xml"):
        read_gestuary(tmp_path / "none.xml")


@pytest.mark.skipif(not CORPUS_FOLDER.is_dir(), reason="no corpus; set KINESIC_CORPUS")
@pytest.mark.parametrize(
    ("name", "count", "usable"), [("gestuary", 12, 12), ("gestuary_camille", 282, 273), ("gestuary_poppy", 179, 116)]
)
def test_gestuaries_of_the_corpus_are_read(name, count, usable):
    forms = read_gestuary(CORPUS_FOLDER / f"{name}.xml")
    assert len(forms) == count
    assert sum(is_enabled(form) for form in forms) == usable
    for form in forms:
        for pose in (pose for key in form.keys for pose in key.hands.values()):
            assert np.isfinite(pose.position).all()
            assert 0 <= pose.openness <= 1
            for direction in (pose.palm, pose.pointing):
                assert direction is None or np.linalg.norm(direction) == pytest.approx(1.0)


@pytest.mark.skipif(not CORPUS_FOLDER.is_dir(), reason="no corpus; set KINESIC_CORPUS")
def test_gestures_of_a_gestuary_file_take_precedence_over_builtin_ones():
    lexicon = Lexicon.load(CORPUS_FOLDER / "gestuary_camille.xml")
    for form in (form for form in read_gestuary(CORPUS_FOLDER / "gestuary_camille.xml") if is_enabled(form)):
        match = lexicon.find(f"{form.category}={form.id.upper()}")
        assert match is not None
        assert match.substitute == ""
        assert match.form.id.lower() == form.id.lower()
    assert lexicon.find("no_wag").form.id == "no_wag"


CIRCLE_TRAJECTORY = """<Trajectory type="CIRCLE">
  <x amplitude="0.2" frequency="2" spatialVariation="GREATER"/><y amplitude="0.1" frequency="2" shift="0.25"/>
</Trajectory>"""


def moved(trajectory, **options):
    return hand(**options).replace("</hand>", f"{trajectory}</hand>")


def test_gestuary_trajectory_becomes_the_hand_path_of_its_phase(read):
    first, second = (key.hands["l"] for key in read(hand(), moved(CIRCLE_TRAJECTORY)).keys)
    assert first.path is None
    assert second.path.kind == "circle"
    assert second.path.amplitude == pytest.approx([0, 0.2, 0.1])
    assert second.path.shift == pytest.approx([0, 0, 0.25])
    assert second.path.turns == 2
    assert second.path.amplitude_variation == "grows"


def test_gestuary_trajectory_of_the_first_phase_is_moved_to_the_second(read):
    first, second = (key.hands["l"] for key in read(moved(CIRCLE_TRAJECTORY), hand()).keys)
    assert first.path is None
    assert second.path.kind == "circle"


def test_gestuary_trajectory_is_not_inherited(read):
    keys = read(hand(), moved(CIRCLE_TRAJECTORY), hand()).keys
    assert [key.hands["l"].path is None for key in keys] == [True, False, True]


def test_gestuary_trajectory_without_axes_has_default_parameters(read):
    assert read(hand(), moved('<Trajectory type="wave"/>')).keys[1].hands["l"].path.turns == 2


@pytest.mark.parametrize(
    ("trajectory", "said"),
    [
        ('<Trajectory type="circel"/>', r"own\.xml:\d+: <Trajectory> type is 'circel'; did you mean circle"),
        (
            '<Trajectory type="wave"><x amplitude="9" frequency="1"/></Trajectory>',
            r"<Trajectory> amplitude is \[9, 0, 0\]",
        ),
        (CIRCLE_TRAJECTORY.replace("GREATER", "MORE"), "spatialVariation is 'MORE'"),
        (CIRCLE_TRAJECTORY.replace('"0.2"', '"wide"'), "amplitude is 'wide', not a number"),
    ],
)
def test_invalid_gestuary_trajectory_error_has_file_and_line(read, trajectory, said):
    with pytest.raises(ConfigError, match=said):
        read(hand(), moved(trajectory))


def test_numeric_gestuary_position_out_of_reach_is_refused_at_its_line(tmp_path):
    path = tmp_path / "own.xml"
    phase = hand().replace('value="0.3"', 'value="1e11"')
    path.write_text(f'<gestuary><gesture category="deictic" id="Own"><phase>{phase}</phase></gesture></gestuary>')
    with pytest.raises(ConfigError, match=r"own\.xml:3: <uniformPosition> a hand is 1e\+11 arm lengths"):
        read_gestuary(path)
