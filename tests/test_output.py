import json

import pytest

from horizon_dl.errors import InputError
from horizon_dl.output import output_folder, write_json


def test_files_appear_only_when_all_went_well(tmp_path):
    out = tmp_path / "deep" / "out"
    with output_folder(out) as folder:
        (folder / "sub").mkdir()
        (folder / "sub" / "a.txt").write_text("new")
        assert not out.exists()
    assert (out / "sub" / "a.txt").read_text() == "new"
    assert [path.name for path in out.parent.iterdir()] == ["out"]


def _fail_half_way(folder):
    (folder / "a.txt").write_text("half")
    raise KeyError


def test_an_error_leaves_earlier_results_as_they_were(tmp_path):
    out = tmp_path / "out"
    out.mkdir()
    (out / "a.txt").write_text("old")
    with pytest.raises(KeyError), output_folder(out) as folder:
        _fail_half_way(folder)
    assert (out / "a.txt").read_text() == "old"
    assert [path.name for path in tmp_path.iterdir()] == ["out"]


def test_later_results_replace_earlier_ones_and_keep_other_files(tmp_path):
    for name, text in (("a", "1"), ("b", "2"), ("a", "3")):
        with output_folder(tmp_path / "out") as folder:
            (folder / "sub").mkdir()
            (folder / "sub" / name).write_text(text)
    assert (tmp_path / "out" / "sub" / "a").read_text() == "3"
    assert (tmp_path / "out" / "sub" / "b").read_text() == "2"


def test_a_file_in_the_place_of_the_folder(tmp_path):
    (tmp_path / "out").write_text("mine")
    with pytest.raises(InputError, match="is a file"), output_folder(tmp_path / "out"):
        pass
    with pytest.raises(InputError, match="cannot be written"), output_folder(tmp_path / "out" / "below"):
        pass
    assert (tmp_path / "out").read_text() == "mine"


def test_json_has_no_nan(tmp_path):
    with pytest.raises(ValueError, match="JSON"):
        write_json(tmp_path / "a.json", {"auc": float("nan")})
    write_json(tmp_path / "a.json", {"auc": None})
    assert json.loads((tmp_path / "a.json").read_text()) == {"auc": None}
    assert [path.name for path in tmp_path.iterdir()] == ["a.json"]
