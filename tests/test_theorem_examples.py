from hypothesis.internal.conjecture import providers


def test_hypothesis_collects_no_constants_of_imported_modules():
    constants = providers._get_local_constants()
    assert not any(constants.set_for_type(kind) for kind in ("integer", "float", "string", "bytes"))
