"""Speech written beside a glTF scene."""

from pathlib import Path

import pytest

from kinesic.body.config import ConfigError
from kinesic.metrics.dry_run import DryRun
from kinesic.report.gltf import scene
from kinesic.report.gltf.scene import save_voice


@pytest.fixture
def spoken(monkeypatch: pytest.MonkeyPatch) -> object:
    speech = object()
    monkeypatch.setattr(scene, "sound", lambda plan: speech)
    monkeypatch.setattr(scene, "write_wav", lambda found, path: path.write_text(f"wav {found is speech}"))
    return speech


def test_sound_of_a_plan_is_written_as_a_wav_file_beside_its_gltf_scene(
    hurried: DryRun, spoken: object, tmp_path: Path
) -> None:
    path = save_voice(hurried.plan, tmp_path / "hurried.glb", force=False)
    assert path == tmp_path / "hurried.wav"
    assert path.read_text() == "wav True"
    with pytest.raises(ConfigError, match=r"hurried\.wav"):
        save_voice(hurried.plan, tmp_path / "hurried.glb", force=False)
    assert save_voice(hurried.plan, tmp_path / "hurried.glb", force=True) == path


def test_gltf_scene_of_a_plan_without_sound_has_no_wav_file(
    hurried: DryRun, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(scene, "sound", lambda plan: None)
    assert save_voice(hurried.plan, tmp_path / "hurried.glb", force=False) is None
    assert list(tmp_path.iterdir()) == []


def test_wav_file_beside_a_gltf_scene_never_replaces_the_recording_of_the_plan(
    hurried: DryRun, spoken: object, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(scene, "_list_recordings", lambda plan: {(tmp_path / "said.wav").resolve()})
    with pytest.raises(ConfigError, match="the voice would replace the recording"):
        save_voice(hurried.plan, tmp_path / "said.glb", force=True)
    assert list(tmp_path.iterdir()) == []
