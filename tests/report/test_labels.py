"""Readable names of behaviours."""

import pytest

from kinesic.bml.parse import parse
from kinesic.planning.syncs import SyncTime
from kinesic.report.labels import MAX_LABEL_LENGTH, label, label_sync, label_with_id

NAMES = {
    '<gesture lexeme="beat" stroke="1"/>': "beat",
    '<head lexeme="NOD" stroke="1"/>': "NOD",
    '<pointing target="left"/>': "point at left",
    '<gaze target="audience" start="0" end="1"/>': "look at audience",
    '<gaze target="left" offsetAngle="20" offsetDirection="UP" start="0" end="1"/>': "look at left UP",
    '<headDirectionShift target="left"/>': "head to left",
    '<faceLexeme lexeme="smile" start="0"/>': "smile",
    '<faceFacs au="12" start="0"/>': "AU 12",
    '<posture start="0" end="2"><stance type="STANDING"/><pose part="ARMS" lexeme="ARMS_CROSSED"/></posture>': (
        "STANDING, ARMS ARMS_CROSSED"
    ),
    '<posture start="0" end="2"><pose part="WHOLEBODY" lexeme="LEANING_FORWARD"/></posture>': "LEANING_FORWARD",
    '<locomotion target="door"/>': "go to door",
    '<wait duration="1"/>': "wait",
    "<speech><text>Hello.</text></speech>": "speech",
    '<dance style="slow"/>': "dance",
}


@pytest.mark.parametrize(("written", "name"), NAMES.items())
def test_behaviour_label_names_its_action(written: str, name: str):
    (behaviour,) = parse(f'<bml id="b">{written}</bml>', dialect="draft").behaviours
    assert label(behaviour) == name


def test_long_behaviour_label_in_a_report_is_truncated():
    (behaviour,) = parse(f'<bml id="b"><gesture id="g" lexeme="{"very" * 30}"/></bml>').behaviours
    assert len(label(behaviour)) == MAX_LABEL_LENGTH
    assert label(behaviour).endswith("\u2026")


def test_behaviour_label_is_followed_by_the_behaviour_id_if_it_differs():
    block = parse('<bml id="b"><gesture id="g9" lexeme="offer"/><head id="nod" lexeme="NOD"/></bml>')
    assert [label_with_id(id, block) for id in ("g9", "nod", "gone")] == ["offer (g9)", "NOD", "gone"]
    assert label_sync(SyncTime("g9", "stroke", 0.0, 0.0), block) == "stroke of offer (g9)"
