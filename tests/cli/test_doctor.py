from kinesic.cli import doctor


def test_doctor_prints_install_commands_with_their_brackets(kinesic, monkeypatch):
    remedy = "espeak-ng is missing: pip install 'kinesic[speech]'"
    monkeypatch.setattr(doctor, "COMPONENT_CHECKS", {"speech": lambda: remedy, "film": lambda: ""})
    ended = kinesic("doctor")
    assert ended.code == 0
    assert remedy in ended.out
    assert [line.split()[-1] for line in ended.out.splitlines() if line.split()[:1] == ["film"]] == ["works"]
