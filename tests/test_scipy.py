"""SciPy is needed by extras alone: the core runs without it."""

import ast
import json
import subprocess
import sys
from pathlib import Path

import pytest

PACKAGE = Path(__file__).resolve().parent.parent / "kinesic"
SCIPY_USERS = ("bench/", "studies/", "face/assets/late_scipy.py")  # files of extras that may import SciPy
# Runs command lines in one process in which SciPy cannot be imported.
WITHOUT_SCIPY = """
import json, sys
sys.modules["scipy"] = None
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


def run_without_scipy(folder: Path, *commands: tuple[str, ...]) -> subprocess.CompletedProcess[str]:
    code = [sys.executable, "-c", WITHOUT_SCIPY, json.dumps(commands)]
    return subprocess.run(code, cwd=folder, capture_output=True, text=True, check=False)


def imports_scipy(file: Path) -> bool:
    text = file.read_text(encoding="utf-8")
    nodes = list(ast.walk(ast.parse(text))) if "scipy" in text else []
    names = [alias.name for node in nodes if isinstance(node, ast.Import) for alias in node.names]
    names += [node.module or "" for node in nodes if isinstance(node, ast.ImportFrom)]
    return any(name.partition(".")[0] == "scipy" for name in names)


def test_only_extras_import_scipy():
    users = [file.relative_to(PACKAGE).as_posix() for file in sorted(PACKAGE.rglob("*.py")) if imports_scipy(file)]
    assert [user for user in users if not user.startswith(SCIPY_USERS)] == []


@pytest.mark.soak
def test_plan_performance_report_and_scene_need_no_scipy(tmp_path):
    (tmp_path / "hello.bml").write_text(BLOCK)
    ended = run_without_scipy(
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
    ("command", "extra"),
    [
        (("plan", "welcome", "--robot", "human", "--out", "human.glb"), "face"),
        (("sweep", "beat", "--parameter", "power"), "studies"),
    ],
)
def test_missing_scipy_is_one_line_that_names_the_extra(command, extra, tmp_path):
    ended = run_without_scipy(tmp_path, command)
    assert ended.returncode != 0
    assert ended.stderr.count("\n") == 1
    assert f'kinesic[{extra}]"' in ended.stderr
