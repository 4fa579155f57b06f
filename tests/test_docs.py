"""What the user's guide shows works, and what it points at exists."""

import ast
import re
import runpy
import tomllib
from collections import Counter
from importlib import import_module
from pathlib import Path

import pytest

from kinesic.body.robot import Robot
from kinesic.controller.perform import perform, set_up
from kinesic.expressivity.lexicon.hand_shapes import hand_shapes
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.hardware.protocol.servo_map import ServoMap
from kinesic.report.checks import checks
from kinesic.studies.gestures.vocabulary import vocabulary

ROOT = Path(__file__).resolve().parent.parent
CONTRIBUTING = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
PAGES = sorted([*ROOT.glob("*.md"), *(ROOT / "docs").glob("*.md")])


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_links_lead_somewhere(page: Path):
    links = re.findall(r"\]\(([^)#]+)[^)]*\)", page.read_text(encoding="utf-8"))
    local = [link for link in links if not link.startswith(("http://", "https://"))]
    assert [link for link in local if not (page.parent / link).exists()] == []


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_what_a_page_imports_is_there(page: Path):
    snippets = re.findall(r"```python\n(.*?)```", page.read_text(encoding="utf-8"), re.DOTALL)
    imports = [node for text in snippets for node in ast.walk(ast.parse(text)) if isinstance(node, ast.ImportFrom)]
    names = [(str(node.module), name.name) for node in imports for name in node.names]
    assert [name for name in names if not hasattr(import_module(name[0]), name[1])] == []


def test_the_index_lists_every_page_once():
    index = (ROOT / "docs" / "index.md").read_text(encoding="utf-8")
    listed = re.findall(r"^\| \[([\w-]+\.md)\]\(\1\) \| \S.*\|$", index, re.MULTILINE)
    assert sorted(listed) == sorted(page.name for page in (ROOT / "docs").glob("*.md") if page.name != "index.md")


def test_every_path_that_contributors_are_shown_exists():
    """What stands in backticks and has a slash or ends as a file does; NAME stands for any name."""
    prose = re.sub(r"```.*?```", "", CONTRIBUTING, flags=re.DOTALL)
    paths = re.findall(r"`([\w.*/-]+/[\w.*/-]*|[\w-]+\.(?:py|md|toml))`", prose)
    assert len(paths) > 100
    assert [path for path in paths if not any(ROOT.glob(path.replace("NAME", "*")))] == []


def test_contributors_are_shown_the_layers_of_the_contract_and_the_duty_of_each_room():
    tools = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]
    contracts = tools["importlinter"]["contracts"]
    (layers,) = [contract["layers"] for contract in contracts if contract.get("containers") == ["kinesic"]]
    (picture,) = [text for text in re.findall(r"```\n(.*?)```", CONTRIBUTING, re.DOTALL) if text.startswith("cli\n")]
    assert picture.splitlines() == layers
    duties = re.findall(r"^\| `kinesic/(\w+)(?:/|\.py)` \| [^|]+ \|$", CONTRIBUTING, re.MULTILINE)
    assert duties == [room for layer in layers for room in layer.split(" | ")]


def test_an_entry_of_the_changelog_is_one_line():
    _, *releases = re.split(r"^## ", (ROOT / "CHANGELOG.md").read_text(encoding="utf-8"), flags=re.MULTILINE)
    lines = [line for release in releases for line in release.splitlines()[1:] if line]
    assert [line for line in lines if not re.match(r"( *- |### )", line)] == []
    assert [line for line in lines if len(line) >= 140] == []
    assert releases[0].startswith("[Unreleased]")


def test_the_example_of_the_gesture_page_is_a_lexicon(tmp_path: Path):
    page = (ROOT / "docs" / "my-gestures.md").read_text(encoding="utf-8")
    file = tmp_path / "mine.toml"
    file.write_text(re.findall(r"```toml\n(.*?)```", page, re.DOTALL)[0], encoding="utf-8")
    lexicon = Lexicon.load(file)
    scales, lift = lexicon.find("weigh_up"), lexicon.find("LIFT")
    assert scales is not None
    assert lift is not None
    assert (scales.form.sides, len(scales.form.keys), scales.substitute) == ({"l", "r"}, 2, "")
    assert lift.form.keys[1].hands["l"].position.tolist() == [0.65, 0.5, 0.6]
    assert lift.form.keys[1].hands["l"].fixed == (True, False, False)


def test_the_page_of_gestures_is_in_step_with_the_lexicon():
    script = runpy.run_path(str(ROOT / "docs" / "make" / "gestures.py"))
    known = set_up()
    written = (ROOT / "docs" / "gestures.md").read_text(encoding="utf-8")
    assert written == script["page"](vocabulary(known.lexicon, known.pace)), "run docs/make/gestures.py"
    assert (ROOT / "docs" / "gestures.png").stat().st_size < 1.5e6


def test_the_page_of_names_is_in_step_with_the_table():
    script = runpy.run_path(str(ROOT / "docs" / "make" / "synonyms.py"))
    written = (ROOT / "docs" / "synonyms.md").read_text(encoding="utf-8")
    assert written == script["page"](Lexicon.load()), "run docs/make/synonyms.py"


def test_the_example_of_names_is_a_lexicon(tmp_path: Path):
    page = (ROOT / "docs" / "my-gestures.md").read_text(encoding="utf-8")
    gestures, names = re.findall(r"```toml\n(.*?)```", page, re.DOTALL)
    (tmp_path / "gestures.toml").write_text(gestures, encoding="utf-8")
    (tmp_path / "names.toml").write_text(names, encoding="utf-8")
    lexicon = Lexicon.load(tmp_path)
    found = {name: lexicon.find(name) for name in ("Grüß Gott!", "on_balance_2H", "waltz", "versus")}
    assert {name: match and match.form.id for name, match in found.items()} == {
        "Grüß Gott!": "greet_wave",
        "on_balance_2H": "weigh_up",
        "waltz": "conduct",
        "versus": "weigh_up",
    }


def test_the_gesture_page_describes_every_shape():
    page = (ROOT / "docs" / "my-gestures.md").read_text(encoding="utf-8")
    assert all(f"| `{name}` | {shape.says} |" in page for name, shape in hand_shapes().items())


def test_the_page_of_hands_judges_every_gesture_that_needs_fingers():
    page = (ROOT / "docs" / "hands.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| `(\w+)` \| (.*) \| (readable|partly|no) \| (readable|partly|no) \|$", page, re.MULTILINE)
    simple = {"relaxed", "open", "flat", "curved", "spread", "fist", "grip", "claw"}
    forms = [form for form in Lexicon.load().forms if set(form.shapes) - simple or form.fingers]
    assert [id for id, *_ in rows] == sorted(form.id for form in forms)
    assert f"All {len(rows)} gestures" in page
    for column, body in enumerate(("mittens, upper22", "fingers, upper36"), 2):
        counts = [sum(row[column] == word for row in rows) for word in ("readable", "partly", "no")]
        assert f"| {body} | {' | '.join(map(str, counts))} |" in page


def test_the_report_page_names_every_check():
    page = (ROOT / "docs" / "report.md").read_text(encoding="utf-8")
    named = set(re.findall(r"`(\w+\.\w+)`", page[page.index("| check |") :]))
    block = (
        '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b"><gesture id="g" lexeme="beat" stroke="1"/></bml>'
    )
    assert {check.name for check in checks(perform(block))} <= named


def test_the_robot_page_lists_the_servos_of_upper22_and_their_ids():
    page = (ROOT / "docs" / "my-robot.md").read_text(encoding="utf-8")
    robot = Robot.load()
    pieces = Counter[str]()
    for drive in robot.drives:
        pieces[drive.servo.name] += drive.count
    listed = {
        name.lower().replace("-", "_"): int(count) for name, count in re.findall(r"\| (X\S+)-T \| (\d+) \|", page)
    }
    assert listed == dict(pieces)
    for row in ServoMap.of(robot).servos:
        name, ids = row.hinge.removeprefix("l_").removeprefix("r_"), ", ".join(str(servo) for servo in row.ids)
        (line,) = [line for line in page.splitlines() if re.search(rf"\| `{name}` \| [\d, |]*\b{ids}\b", line)]
        assert line


def test_the_buses_of_the_robot_page_are_a_robots(tmp_path: Path):
    page = (ROOT / "docs" / "my-robot.md").read_text(encoding="utf-8")
    (buses,) = re.findall(r"```toml\n(.*?)```", page, re.DOTALL)
    text = Robot.load().path.read_text(encoding="utf-8")
    file = tmp_path / "mine.toml"
    file.write_text(text[: text.index("[[bus]]")] + buses, encoding="utf-8")
    wiring = ServoMap.of(Robot.load(file))
    assert [bus.name for bus in wiring.buses] == ["trunk", "arms"]
    assert len(wiring.servos) == 22
