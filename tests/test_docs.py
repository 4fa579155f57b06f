"""Documentation: shown code works and linked targets exist."""

import ast
import re
import runpy
import tomllib
from collections import Counter
from importlib import import_module
from pathlib import Path

import pytest

from kinesic.body.robot import Robot
from kinesic.expressivity.lexicon.hand_shapes import hand_shapes
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.hardware.protocol.servo_map import ServoMap
from kinesic.session.setup import set_up
from kinesic.studies.gestures.vocabulary import list_vocabulary

from .naming import about

ROOT = Path(__file__).resolve().parent.parent
ARCHITECTURE = ROOT / "docs" / "explanation" / "architecture.md"
GUIDES = ROOT / "docs" / "how-to"
REFERENCE = ROOT / "docs" / "reference"
THESIS_MAP = ROOT / "docs" / "explanation" / "thesis-map.md"
SKILLS = sorted((ROOT / "skills").glob("*/SKILL.md"))
CODE_MAP_PAGES = [ROOT / "CONTRIBUTING.md", ROOT / "AGENTS.md", ARCHITECTURE, THESIS_MAP, GUIDES / "run-the-tests.md"]
PAGES = sorted([*ROOT.glob("*.md"), *SKILLS, *(ROOT / "docs").rglob("*.md")])


def test_documentation_links_have_targets():
    for page in PAGES:
        links = re.findall(r"\]\(([^)#]+)[^)]*\)", page.read_text(encoding="utf-8"))
        local = [link for link in links if not link.startswith(("http://", "https://"))]
        with about(page.relative_to(ROOT)):
            assert [link for link in local if not (page.parent / link).exists()] == []


def test_names_imported_in_documentation_examples_exist():
    for page in PAGES:
        snippets = re.findall(r"```python\n(.*?)```", page.read_text(encoding="utf-8"), re.DOTALL)
        imports = [node for text in snippets for node in ast.walk(ast.parse(text)) if isinstance(node, ast.ImportFrom)]
        names = [(str(node.module), name.name) for node in imports for name in node.names]
        names = [name for name in names if name[0].startswith("kinesic")]
        with about(page.relative_to(ROOT)):
            assert [name for name in names if not hasattr(import_module(name[0]), name[1])] == []


def test_site_navigation_lists_each_page_once():
    _, navigation = (ROOT / "mkdocs.yml").read_text(encoding="utf-8").split("\nnav:\n")
    listed = re.findall(r"^ *- (?:[^:\n]+: )?([\w./-]+\.md)$", navigation, re.MULTILINE)
    pages = [page.relative_to(ROOT / "docs").as_posix() for page in (ROOT / "docs").rglob("*.md")]
    assert sorted(listed) == sorted(pages), "edit nav in mkdocs.yml"


@pytest.mark.parametrize("section", ["how-to", "reference", "explanation", "tutorials", "benchmarks"])
def test_index_of_each_documentation_section_links_each_page_once(section: str):
    folder = ROOT / "docs" / section
    links = re.findall(r"\]\(([\w/-]+\.md)\)", (folder / "index.md").read_text(encoding="utf-8"))
    pages = [page.relative_to(folder).as_posix() for page in folder.rglob("*.md") if page.name != "index.md"]
    assert sorted(links) == sorted(pages), f"edit docs/{section}/index.md"


@pytest.mark.parametrize("page", CODE_MAP_PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_file_paths_named_on_pages_for_contributors_exist(page: Path):
    """Paths in backticks contain a slash or a file suffix; NAME is a placeholder."""
    prose = re.sub(r"```.*?```", "", page.read_text(encoding="utf-8"), flags=re.DOTALL)
    paths = re.findall(r"`([\w.*/-]+/[\w.*/-]*|[\w-]+\.(?:py|md|toml))`", prose)
    assert len(paths) > 5
    assert [path for path in paths if not any(ROOT.glob(path.replace("NAME", "*")))] == []


@pytest.mark.parametrize("page", SKILLS, ids=lambda page: page.parent.name)
def test_project_files_named_in_skills_exist(page: Path):
    """Files of the user, such as `mine.toml`, have no slash."""
    prose = re.sub(r"```.*?```", "", page.read_text(encoding="utf-8"), flags=re.DOTALL)
    roots = "|".join(path.name for path in ROOT.iterdir() if path.is_dir() and not path.is_symlink())
    paths = re.findall(rf"`(?:\.venv/bin/python )?((?:{roots})/[\w./-]*)`", prose)
    assert [path for path in paths if not any(ROOT.glob(path.replace("NAME", "*")))] == []


def test_architecture_page_lists_packages_in_layer_order():
    tools = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]
    contracts = tools["importlinter"]["contracts"]
    (layers,) = [contract["layers"] for contract in contracts if contract.get("containers") == ["kinesic"]]
    text = ARCHITECTURE.read_text(encoding="utf-8")
    duties = re.findall(r"^\| `kinesic/(\w+)(?:/|\.py)` \| [^|]+ \|$", text, re.MULTILINE)
    assert duties == [package for layer in layers for package in layer.split(" | ")], f"edit {ARCHITECTURE}"


def test_package_layer_picture_of_the_documentation_contains_the_current_packages_in_order(tmp_path: Path):
    generator = runpy.run_path(str(ROOT / "docs" / "make" / "layers.py"))
    generator["draw"](generator["read_layers"]())
    drawn = [name for layer in generator["read_layers"]() for name in layer]
    assert generator["names_in"](ROOT / "docs" / "pictures" / "layers.svg") == drawn, "run docs/make/layers.py"


def test_contributing_guide_has_at_most_eighty_lines():
    assert len((ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8").splitlines()) <= 80


def test_changelog_entries_have_one_line_below_140_characters():
    _, *releases = re.split(r"^## ", (ROOT / "CHANGELOG.md").read_text(encoding="utf-8"), flags=re.MULTILINE)
    lines = [line for release in releases for line in release.splitlines()[1:] if line]
    assert [line for line in lines if not re.match(r"( *- |### )", line)] == []
    assert [line for line in lines if len(line) >= 140] == []
    assert releases[0].startswith("[Unreleased]")


def test_readme_has_at_most_85_lines_and_one_small_film():
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    assert len(readme.splitlines()) <= 85
    (film,) = re.findall(r"!\[[^]]+\]\((docs/pictures/[\w-]+\.webp)\)", readme)
    assert (ROOT / film).stat().st_size < 3e5


def test_example_on_the_documentation_page_on_writing_gestures_is_a_valid_lexicon(tmp_path: Path):
    page = (GUIDES / "write-a-gesture.md").read_text(encoding="utf-8")
    file = tmp_path / "mine.toml"
    file.write_text(re.findall(r"```toml\n(.*?)```", page, re.DOTALL)[0], encoding="utf-8")
    lexicon = Lexicon.load(file)
    scales, lift = lexicon.find("weigh_up"), lexicon.find("LIFT")
    assert scales is not None
    assert lift is not None
    assert (scales.form.sides, len(scales.form.keys), scales.substitute) == ({"l", "r"}, 2, "")
    assert lift.form.keys[1].hands["l"].position.tolist() == [0.65, 0.5, 0.6]
    assert lift.form.keys[1].hands["l"].fixed == (True, False, False)


def test_gesture_table_of_the_documentation_matches_the_lexicon():
    script = runpy.run_path(str(ROOT / "docs" / "make" / "gestures.py"))
    known = set_up()
    written = (REFERENCE / "gestures.md").read_text(encoding="utf-8")
    assert written == script["page"](list_vocabulary(known.lexicon, known.pace)), "run docs/make/gestures.py"
    assert (ROOT / "docs" / "pictures" / "gestures.png").stat().st_size < 1.5e6


def test_docs_page_of_synonyms_matches_the_lexicon():
    script = runpy.run_path(str(ROOT / "docs" / "make" / "synonyms.py"))
    written = (REFERENCE / "synonyms.md").read_text(encoding="utf-8")
    assert written == script["page"](Lexicon.load()), "run docs/make/synonyms.py"


def test_docs_example_of_synonyms_is_a_valid_lexicon(tmp_path: Path):
    page = (GUIDES / "write-a-gesture.md").read_text(encoding="utf-8")
    gestures, names = re.findall(r"```toml\n(.*?)```", page, re.DOTALL)
    (tmp_path / "gestures.toml").write_text(gestures, encoding="utf-8")
    (tmp_path / "names.toml").write_text(names, encoding="utf-8")
    lexicon = Lexicon.load(tmp_path)
    results = {name: lexicon.find(name) for name in ("Grüß Gott!", "on_balance_2H", "waltz", "versus")}
    assert {name: match and match.form.id for name, match in results.items()} == {
        "Grüß Gott!": "greet_wave",
        "on_balance_2H": "weigh_up",
        "waltz": "conduct",
        "versus": "weigh_up",
    }


def test_gesture_page_describes_each_hand_shape():
    page = (GUIDES / "write-a-gesture.md").read_text(encoding="utf-8")
    assert all(f"| `{name}` | {shape.says} |" in page for name, shape in hand_shapes().items())


def test_hand_shape_page_rates_only_gestures_that_need_fingers_and_counts_them():
    page = (REFERENCE / "hand-shapes.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| `(\w+)` \| (.*) \| (readable|partly|no) \| (readable|partly|no) \|$", page, re.MULTILINE)
    simple = {"relaxed", "open", "flat", "curved", "spread", "fist", "grip", "claw"}
    forms = [form for form in Lexicon.load().forms if set(form.shapes) - simple or form.fingers]
    rated = [id for id, *_ in rows]
    assert rated == sorted(set(rated)), "hand-shapes.md: rows must be sorted, one per gesture"
    assert set(rated) - {form.id for form in forms} == set(), "hand-shapes.md: remove the rows of these gestures"
    assert f"The {len(rows)} gestures in the table below need" in page
    for column, body in enumerate(("mittens, upper22", "fingers, upper36"), 2):
        counts = [sum(row[column] == word for row in rows) for word in ("readable", "partly", "no")]
        assert f"| {body} | {' | '.join(map(str, counts))} |" in page


def test_documentation_page_on_building_a_robot_lists_upper22_servos_and_ids():
    page = (GUIDES / "build-a-robot.md").read_text(encoding="utf-8")
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


def test_servo_buses_in_the_example_of_the_robot_page_are_valid(tmp_path: Path):
    page = (GUIDES / "build-a-robot.md").read_text(encoding="utf-8")
    (buses,) = re.findall(r"```toml\n(.*?)```", page, re.DOTALL)
    text = Robot.load().path.read_text(encoding="utf-8")
    file = tmp_path / "mine.toml"
    file.write_text(text[: text.index("[[bus]]")] + buses, encoding="utf-8")
    wiring = ServoMap.of(Robot.load(file))
    assert [bus.name for bus in wiring.buses] == ["trunk", "arms"]
    assert len(wiring.servos) == 22
