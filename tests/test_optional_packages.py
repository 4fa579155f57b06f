"""SciPy and Pillow are needed only by extras."""

import ast
import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

PACKAGE = Path(__file__).resolve().parent.parent / "kinesic"
USERS = {  # package -> files of extras that may import it
    "scipy": ("bench/", "capture/", "studies/", "face/assets/late_scipy.py"),
    "PIL": ("files/late_pillow.py", "mcp/stroke_picture.py"),
}
# Runs command lines in one process.
COMMANDS = """
import json, sys
from kinesic.cli import main
for words in json.loads(sys.argv[1]):
    sys.argv = ["kinesic", *words]
    try:
        main()
    except SystemExit as ended:
        if ended.code:
            raise
"""
BLOCK = (
    '<bml id="b"><speech id="s"><text>Hello <sync id="w"/>there.</text></speech>'
    '<gesture id="g" lexeme="greet_wave" stroke="s:w"/><gesture id="h" lexeme="beat" start="g:end"/>'
    '<faceLexeme id="f" lexeme="joy" start="0.2" end="1.6"/><gaze id="z" target="person" start="0.4" end="1.2"/></bml>'
)


def run_without(package: str, folder: Path, *commands: tuple[str, ...]) -> subprocess.CompletedProcess[str]:
    """Run command lines, with a package that cannot be imported."""
    (folder / "sitecustomize.py").write_text(f"import sys\nsys.modules[{package!r}] = None\n")
    code = [sys.executable, "-c", COMMANDS, json.dumps(commands)]
    environment = os.environ | {"PYTHONPATH": str(folder)}
    return subprocess.run(code, cwd=folder, env=environment, capture_output=True, text=True, check=False)


def imports(file: Path, package: str) -> bool:
    text = file.read_text(encoding="utf-8")
    nodes = list(ast.walk(ast.parse(text))) if package in text else []
    names = [alias.name for node in nodes if isinstance(node, ast.Import) for alias in node.names]
    names += [node.module or "" for node in nodes if isinstance(node, ast.ImportFrom)]
    return any(name.partition(".")[0] == package for name in names)


@pytest.mark.parametrize("package", USERS)
def test_optional_packages_are_imported_only_by_modules_listed_for_them(package):
    users = [file.relative_to(PACKAGE).as_posix() for file in sorted(PACKAGE.rglob("*.py")) if imports(file, package)]
    assert [user for user in users if not user.startswith(USERS[package])] == []


@pytest.mark.soak
@pytest.mark.parametrize("package", USERS)
def test_plan_performance_report_and_scene_need_no_optional_package(package, tmp_path):
    (tmp_path / "hello.bml").write_text(BLOCK)
    ended = run_without(
        package,
        tmp_path,
        ("plan", "hello.bml", "--out", "hello.npz"),
        ("perform", "hello.bml", "--no-film", "--out", "hello"),
        ("plan", "welcome", "--out", "welcome.glb"),
        ("perform", "welcome", "--robot", "upper36", "--no-film", "--out", "welcome"),
        ("perform", "hello.bml", "--robot", "human", "--no-film", "--out", "human"),
    )
    assert ended.returncode == 0, ended.stderr
    for file in ("hello.npz", "hello/report.html", "welcome.glb", "welcome/report.json", "human/report.html"):
        assert (tmp_path / file).is_file()


@pytest.mark.soak
@pytest.mark.parametrize(
    ("package", "command", "extra"),
    [
        ("scipy", ("plan", "welcome", "--robot", "human", "--out", "human.glb"), "face"),
        ("scipy", ("sweep", "beat", "--parameter", "power"), "studies"),
        ("scipy", ("certify", "wave.bvh"), "capture"),
        ("PIL", ("plan", "welcome", "--robot", "human", "--out", "human.glb"), "film"),
        ("PIL", ("gestures", "render", "hello", "--out", "hello.webp"), "film"),
    ],
)
def test_missing_optional_package_is_reported_in_one_line_with_its_extra(package, command, extra, tmp_path):
    ended = run_without(package, tmp_path, command)
    assert ended.returncode != 0
    assert ended.stderr.count("\n") == 1
    assert f'kinesic[{extra}]"' in ended.stderr
