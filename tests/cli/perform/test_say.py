import json

TEXT = "Hello! There were three big boxes."


def test_say_prints_bml_that_plan_reads(kinesic):
    printed = kinesic("say", TEXT, "--to", "bml")
    assert printed.code == 0
    assert "kinesic:reason=" in printed.out
    assert kinesic("plan", "-", stdin=printed.out.encode()).code == 0


def test_plain_text_file_is_performed_with_a_reason_for_each_behaviour(kinesic, tmp_path):
    (tmp_path / "story.txt").write_text(TEXT)
    ended = kinesic("perform", tmp_path / "story.txt", "--no-film", "--json", "--voice", "durations")
    rows = json.loads(ended.out)["behaviours"]
    assert all(row["reason"] for row in rows if row["type"] != "speech")
    assert "dropped" not in {row["outcome"] for row in rows}


def test_report_of_say_contains_no_file_path(kinesic, tmp_path):
    ended = kinesic("say", TEXT, "--no-film", "--voice", "durations", "--out", tmp_path / "out")
    assert ended.code == 0, ended.err
    assert json.loads((tmp_path / "out" / "report.json").read_text())["input"] == "said"
