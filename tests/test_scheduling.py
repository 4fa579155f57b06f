"""Which process begins where."""

from pathlib import Path

from .scheduling import LONGEST, begin_elsewhere, rank


def test_each_process_reads_all_and_begins_elsewhere():
    nodes = list(range(10))
    turned = [begin_elsewhere(nodes, f"gw{k}", 3) for k in range(3)]
    assert all(sorted(own) == nodes for own in turned)
    assert [own[0] for own in turned] == [0, 3, 6]


def test_files_of_one_size_have_an_order_too(tmp_path: Path):
    files = [tmp_path / name for name in ("test_b.py", "test_a.py", "test_large.py")]
    for file, size in zip(files, (3, 3, 9), strict=True):
        file.write_text("#" * size)
    found = sorted(files, key=lambda file: rank(file, tmp_path))
    assert [file.name for file in found] == ["test_large.py", "test_a.py", "test_b.py"]


def test_the_longest_are_there():
    assert all((Path(__file__).parents[1] / name).is_file() for name in LONGEST)
