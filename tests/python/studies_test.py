# SPDX-License-Identifier: Apache-2.0
"""Studies run by a Python function."""
import pytest
import subvol

def test_the_built_in_studies():
    assert "order" in subvol.studies()
    study = subvol.study("order")
    assert study.name == "order" and len(study) == len(study.cases) > 1
    case = study.cases[0]
    assert len(case.id) == 16 and isinstance(case.values, dict) and case.name in repr(case)
    assert f"{len(study)} cases" in repr(study)


def test_a_run_is_kept_and_goes_on(tmp_path):
    study, ran = subvol.study("order"), []

    def work(case):
        ran.append(case.id)
        if len(ran) == 2:
            raise RuntimeError("the second one fails")
        return {"answer": len(case.name), "ratio": .5}

    first = subvol.run_study(study, work, tmp_path)
    assert ran == [case.id for case in study.cases]
    assert first.failed == 1 and first.ran == len(study)
    assert first.results[0]["metrics"] == {"answer": len(study.cases[0].name), "ratio": .5}
    assert first.results[1]["failure"] == "RuntimeError: the second one fails"
    again = subvol.run_study(study, work, tmp_path)
    assert again.failed == 0 and ran[len(study):] == [study.cases[1].id]
    assert "answer" in again.csv() and isinstance(again.tables(), list)
    assert subvol.run_study(study, work, tmp_path, fresh=True).ran == len(study)


def test_what_is_no_study(tmp_path):
    for wrong in ("nothing", {"name": "x"}, {"nonsense": 1}):
        with pytest.raises(subvol.InvalidInput):
            subvol.study(wrong)
    (tmp_path / "s.json").write_text("{")
    with pytest.raises(subvol.InvalidInput):
        subvol.study(tmp_path / "s.json")
    result = subvol.run_study(subvol.study("order"), lambda case: {"text": "three"}, tmp_path / "out")
    assert result.failed == len(subvol.study("order")) and "ValueError" in result.results[0]["failure"]
    result = subvol.run_study(subvol.study("order"), lambda case: 3, tmp_path / "out2")
    assert result.failed == len(subvol.study("order"))


def test_ctrl_c_ends_a_study(tmp_path):
    def work(case):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        subvol.run_study(subvol.study("order"), work, tmp_path)
