"""Order of test files in each process."""

from pathlib import Path

from .scheduling import SERVER_FOLDERS, begin_elsewhere, choose_file, rank


def test_each_test_process_collects_all_files_in_another_order():
    nodes = list(range(10))
    turned = [begin_elsewhere(nodes, f"gw{k}", 3) for k in range(3)]
    assert all(sorted(own) == nodes for own in turned)
    assert [own[0] for own in turned] == [0, 3, 6]


def test_larger_test_files_come_first_and_equal_ones_in_order_of_name(tmp_path: Path):
    files = [tmp_path / name for name in ("test_b.py", "test_a.py", "test_large.py")]
    for file, size in zip(files, (3, 3, 9), strict=True):
        file.write_text("#" * size)
    results = sorted(files, key=lambda file: rank(file, tmp_path))
    assert [file.name for file in results] == ["test_large.py", "test_a.py", "test_b.py"]


def test_files_of_folders_with_a_shared_server_come_first_and_in_succession(tmp_path: Path):
    names = ("tests/serve/test_b.py", "tests/studio/test_a.py", "tests/test_large.py", "tests/serve/desk/test_c.py")
    for name in names:
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text("#" * len(name))
    results = sorted((tmp_path / name for name in names), key=lambda file: rank(file, tmp_path))
    assert [file.name for file in results] == ["test_a.py", "test_c.py", "test_b.py", "test_large.py"]


def test_studio_files_run_in_the_browser_process(tmp_path: Path):
    names = ["tests/test_large.py", "tests/studio/test_a.py"]
    for name in names:
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).touch()
    chosen = {worker: choose_file(names, worker, tmp_path) for worker in ("gw0", "gw1", "gw2")}
    assert chosen == {"gw0": names[1], "gw1": names[0], "gw2": names[0]}


def test_folders_listed_with_a_shared_server_exist():
    assert all((Path(__file__).parents[1] / folder).is_dir() for folder in SERVER_FOLDERS)


def test_browser_test_files_run_in_one_process_while_other_files_remain(tmp_path: Path):
    texts = {"sum.py": "", "tick.py": "pytest.mark.realtime", "page.py": "from ..chromium import opened"}
    for name, text in texts.items():
        (tmp_path / name).write_text(text)
    chosen = {worker: choose_file(texts, worker, tmp_path) for worker in ("gw0", "gw1", "gw2")}
    assert chosen == {"gw0": "page.py", "gw1": "tick.py", "gw2": "sum.py"}
    assert choose_file(["tick.py", "page.py"], "gw2", tmp_path) == "tick.py"
    assert choose_file(["page.py"], "gw2", tmp_path) == "page.py"
