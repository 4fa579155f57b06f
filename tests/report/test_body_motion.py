from kinesic.report.page import describe_body_motion


def test_accompanying_body_motion_is_described_in_words() -> None:
    body = {"head_deg": 8.0, "trunk_deg": 0.3, "shoulders_deg": -4.6, "eyes_deg": None, "face": {"smile": 0.5}}
    assert (
        describe_body_motion({"body": {**body, "gave_way": ["eyes"]}})
        == "head 8°, shoulders -5°, smile, eyes left to others"
    )
    assert describe_body_motion({"body": None}) == ""
