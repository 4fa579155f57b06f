"""`kinesic plan` without a file: what would happen when, and nothing is written."""

import re
from pathlib import Path
from xml.etree import ElementTree

BLOCK = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">{}</bml>'
TALK = BLOCK.format(
    '<speech id="s"><text>Good <sync id="m"/>morning to you all, wherever you may be today</text></speech>'
    '<head id="h" lexeme="NOD" stroke="s:m"/><gesture id="rushed" lexeme="offer" mode="RIGHT_HAND" start="0" '
    'stroke="0.25" end="0.6"/><gesture id="odd" lexeme="xyzzy"/><faceLexeme id="f" lexeme="smile" start="1" end="2"/>'
).encode()


def test_it_prints_a_timeline_and_writes_nothing(kinesic, tmp_path: Path):
    ended = kinesic("plan", "-", stdin=TALK)
    assert ended.code == 0, ended.err
    heading, *lines = ended.out.splitlines()
    assert heading.split() == ["from", "to", "behaviour", "does", "sync", "points"]
    rows = [line.split() for line in lines[:-2] if not line.startswith(" " * 15)]  # without lines that go on
    assert {row[2] for row in rows} == {"s", "h", "rushed", "f"}, "what is dropped has no time"
    assert [float(row[0]) for row in rows] == sorted(float(row[0]) for row in rows)
    for shown in ('s          "Good morning to you all, where..."', "head NOD", "gesture offer", "smile"):
        assert shown in ended.out
    assert lines[-1].startswith("nothing is written: --out motion.npz")
    assert list(tmp_path.iterdir()) == []


def test_gestures_are_shown_with_the_entry_that_stands_for_their_name_and_their_hands(kinesic):
    named = ("LHandOnHip_Motex", "this_index_RH", "applause", "NOD")
    asked = "".join(f'<gesture id="g{k}" lexeme="{name}" start="{4 * k}"/>' for k, name in enumerate(named))
    words = " ".join(kinesic("plan", "-", stdin=BLOCK.format(asked).encode()).out.split())
    assert "gesture LHandOnHip_Motex as hand_on_hip, left hand ready" in words
    assert "gesture this_index_RH as this_index, right hand ready" in words
    assert "gesture applause, both hands ready" in words
    assert "gesture NOD ready" in words, "it is done by the head"


def test_sync_points_that_move_say_when_they_were_asked(kinesic):
    ended = kinesic("plan", "-", stdin=TALK)
    moved = re.findall(r"(\w+) (-?[\d.]+) \(asked ([\d.]+)\)", " ".join(ended.out.split()))
    assert {sync for sync, _, _ in moved} >= {"start", "ready"}, "the gesture begins before it was asked"
    assert "stroke" not in {sync for sync, _, _ in moved}, "its stroke is in time"
    assert all(float(planned) < float(asked) for _, planned, asked in moved)
    assert re.search(r" m 0\.\d\d *$", ended.out, re.MULTILINE)


def test_dropped_behaviours_are_the_first_warnings(kinesic):
    ended = kinesic("plan", "-", stdin=TALK)
    first, *others = ended.err.splitlines()
    assert first.startswith("dropped     xyzzy (odd): ")
    assert any(line.startswith("warning     offer (rushed): ") for line in others)


def test_a_motion_that_was_made_elsewhere_has_no_behaviours(kinesic, tmp_path: Path):
    assert kinesic("plan", "-", "--out", "nod.bap", stdin=TALK).code == 0
    (tmp_path / "nod.bap").rename(tmp_path / "NOD.BAP")
    ended = kinesic("plan", "NOD.BAP")
    assert ended.code == 0, ended.err
    assert ended.out.splitlines()[-1].startswith("nothing is written")
    assert "behaviour" not in ended.out


def test_a_stroke_on_a_word_says_when_the_hand_is_fastest(kinesic):
    tied = TALK.replace(b'start="0" stroke="0.25" end="0.6"', b'stroke="s:m + 1"')
    words = " ".join(kinesic("plan", "-", stdin=tied).out.split())
    stroke, fastest = map(float, re.search(r"stroke ([\d.]+) \(hand fastest at ([\d.]+)\)", words).groups())
    median = float(re.search(r"hands are fastest ([\d.]+) s from their words \(median, strokes: 1\)", words)[1])
    assert abs(abs(stroke - fastest) - median) < 0.011
    assert "fastest" not in kinesic("plan", "-", stdin=TALK).out


def test_a_terminal_obeys_nothing_of_what_is_printed_as_bml(kinesic, tmp_path):
    odd = "A\u009b2J\u202e\u0085B"
    fml = (
        f'<fml-apml><bml id="b"><head id="h" lexeme="NOD" x="{odd}"/><speech id="s"><tm id="a"/>{odd}</speech></bml>'
        f'<fml><no type="{odd}" start="s:a"/></fml></fml-apml>'
    )
    (tmp_path / "odd.txt").write_text(odd)
    ended = kinesic("plan", "-", "--to", "bml", stdin=fml.encode())
    assert (ended.code, ended.out.count("A&#155;2J&#8238;&#133;B")) == (0, 2)
    assert r"not shown: no-A\x9b2J\u202e\x85B" in ended.err
    tree = ElementTree.fromstring(ended.out)
    assert [tree.find("head").get("x"), "".join(tree.find("speech").itertext()).strip()] == [odd, odd]
    others = [kinesic("plan", "odd.txt", "--to", "bml"), kinesic("say", odd, "--to", "bml")]
    for each in (ended, *others):
        assert each.code == 0, each.err
        assert all(letter.isprintable() or letter == "\n" for letter in each.out + each.err)


def test_fml_is_printed_as_bml_with_what_nothing_shows(kinesic):
    fml = (
        '<fml-apml><bml><speech id="s"><tm id="a"/>Hello you</speech></bml>'
        '<fml><performative type="greet" start="s:a"/><no type="set" start="s:a"/></fml></fml-apml>'
    )
    ended = kinesic("plan", "-", "--to", "bml", stdin=fml.encode())
    assert ended.code == 0, ended.err
    assert "(performative-greet, 0.50)" in ended.out
    assert "not shown: no-set" in ended.err
    assert kinesic("plan", "-", "--to", "bml", stdin=TALK).code == 2, "it is BML already"
