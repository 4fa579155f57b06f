import json


def test_style_list_shows_each_preset_with_its_parameters(kinesic):
    listed = kinesic("styles", "list")
    assert listed.code == 0
    heading, *rows = (line.split() for line in listed.out.splitlines())
    assert heading[:3] == ["style", "spatial", "temporal"]
    assert {row[0] for row in rows} >= {"angry", "calm", "joyful", "neutral", "proud", "sad", "shy"}
    assert next(row for row in rows if row[0] == "neutral")[1:] == ["0"] * 8 + ["1"]


def test_style_show_prints_values_with_unit_and_effect(kinesic):
    shown = kinesic("styles", "show", "sad")
    assert shown.code == 0
    rows = {line.split()[0]: " ".join(line.split()[1:]) for line in shown.out.splitlines()}
    assert rows["spatial"] == "-0.5 -1 .. 1 size of movements: tight .. wide"
    assert rows["head.spatial"] == "-0.6 -1 .. 1 as spatial, of the head alone"
    assert rows["standing.trunk.tilt"] == "9 deg rotation of the trunk: positive down and forward"
    assert rows["prefers.beat_low"].startswith("6 factor")


def test_style_show_applies_settings_and_prints_json(kinesic):
    shown = json.loads(kinesic("styles", "show", "sad", "--set", "head.spatial=-0.5", "--json").out)
    assert shown["name"] == "sad"
    keys = {parameter["key"]: parameter["value"] for parameter in shown["parameters"]}
    assert keys["spatial"] == -0.5
    assert "head.spatial" not in keys
    names = [style["name"] for style in json.loads(kinesic("styles", "list", "--json").out)]
    assert "joyful" in names


def test_styles_show_refuses_an_unknown_style_and_suggests_a_similar_one(kinesic):
    ended = kinesic("styles", "show", "joyfull")
    assert ended.code == 2
    assert "did you mean joyful?" in ended.err
