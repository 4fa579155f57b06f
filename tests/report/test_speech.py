import pytest

from kinesic.metrics.dry_run import DryRun
from kinesic.report.speech import describe_speech


def test_phoneme_times_use_the_clock_of_the_sync_points(hurried: DryRun) -> None:
    plan = hurried.plan
    (result,) = describe_speech(plan)
    assert isinstance(result, dict)
    (speech,) = plan.utterances.values()
    (begins,) = [timed.times["start"] for timed in plan.timeline.timed if timed.behaviour.id == result["id"]]
    assert isinstance(result["phonemes"], list)
    assert len(result["phonemes"]) == len(speech.phonemes) > 5
    for row, sound in zip(result["phonemes"], speech.phonemes, strict=True):
        assert isinstance(row, dict)
        assert row["symbol"] == sound.symbol
        times = [row[name] for name in ("start_s", "end_s", "onset_s", "release_s")]
        assert times == pytest.approx(
            [begins + time for time in (sound.start, sound.end, *sound.articulation)], abs=1e-4
        )
    assert result["heard"] is (speech.sound is not None)
