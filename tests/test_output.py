"""Results: tried before the work, all or nothing, and never at the cost of what was there."""

import errno
import json
import multiprocessing
import os
import shutil
import signal
from pathlib import Path

import pytest

from horizon_dl.errors import InputError, printable
from horizon_dl.output import output_folder, stage, write_json, write_text
from horizon_dl.output.files import system_error
from horizon_dl.output.folder import claim_folder
from horizon_dl.output.manifest import MANIFEST, check_files, file_hash, read_manifest


def write(out: Path, files: dict[str, str], **options) -> None:
    with output_folder(out, options.pop("kind", "test"), **options) as folder:
        for name, text in files.items():
            write_text(folder / name, text)


def content(out: Path) -> dict[str, str]:
    """All files but the manifest."""
    paths = [path for path in out.rglob("*") if path.is_file() and path.name != MANIFEST]
    return {path.relative_to(out).as_posix(): path.read_text() for path in paths}


def test_files_appear_only_when_all_went_well(tmp_path):
    out = tmp_path / "deep" / "out"
    with output_folder(out, "test") as folder:
        write_text(folder / "sub" / "a.txt", "new")
        assert [path.name for path in out.iterdir() if not path.name.startswith(".")] == []
    assert content(out) == {"sub/a.txt": "new"}
    assert sorted(path.name for path in out.iterdir()) == [MANIFEST, "sub"]
    assert read_manifest(out).files == {"sub/a.txt": file_hash(out / "sub" / "a.txt")}
    assert read_manifest(out).kind == "test"


def _fail_half_way(folder):
    (folder / "a.txt").write_text("half")
    raise KeyError


def test_an_error_leaves_everything_as_it_was(tmp_path):
    out = tmp_path / "out"
    write(out, {"a.txt": "old"})
    with pytest.raises(KeyError), output_folder(out, "test", overwrite=True) as folder:
        _fail_half_way(folder)
    assert content(out) == {"a.txt": "old"}
    with pytest.raises(KeyError), output_folder(tmp_path / "deep" / "new", "test") as folder:
        _fail_half_way(folder)
    assert [path.name for path in tmp_path.iterdir()] == ["out"]


def test_a_folder_that_holds_something_is_refused_unless_told(tmp_path):
    out = tmp_path / "out"
    write(out, {"a": "1"}, kind="predict")
    with pytest.raises(InputError, match=r"holds results of `predict` already; .*--overwrite"):
        write(out, {"a": "2"}, kind="predict")
    foreign = tmp_path / "thesis"
    foreign.mkdir()
    (foreign / "thesis.tex").write_text("years")
    with pytest.raises(InputError, match=r"holds files already, as thesis\.tex"):
        write(foreign, {"a": "2"})
    write(foreign, {"a": "2"}, overwrite=True)
    assert content(foreign) == {"thesis.tex": "years", "a": "2"}


def test_replacing_takes_earlier_results_away_but_nothing_else(tmp_path):
    out = tmp_path / "out"
    write(out, {"panels/1": "1", "panels/2": "2", "notes/3": "3", "a": "1"})
    (out / "panels" / "2").write_text("edited by hand")
    (out / "mine").write_text("mine")
    write(out, {"panels/4": "4", "a": "2"}, overwrite=True)
    assert content(out) == {"panels/2": "edited by hand", "panels/4": "4", "a": "2", "mine": "mine"}
    assert not (out / "notes").exists()


def test_adding_to_a_folder_of_ones_own_keeps_the_rest(tmp_path):
    out = tmp_path / "out"
    claim_folder(out, "online")
    (out / "log").write_text("kept")
    write(out, {"a": "1", "b": "1"}, kind="online", adding=True)
    write(out, {"a": "2"}, kind="online", adding=True)
    assert content(out) == {"a": "2", "b": "1", "log": "kept"}
    assert set(read_manifest(out).files) == {"a", "b"}
    claim_folder(out, "online")
    assert content(out) == {"a": "2", "b": "1", "log": "kept"}
    claim_folder(out, "online", anew=True)
    assert content(out) == {"log": "kept"}
    with pytest.raises(InputError, match="holds results of `online`"):
        claim_folder(out, "train")


def test_what_a_killed_run_wrote_half_goes_from_its_own_folder_alone(tmp_path):
    half = (".checkpoint.safetensors.part", ".tmpAb3xY9")
    for name in ("own", "other"):
        (tmp_path / name).mkdir()
    claim_folder(tmp_path / "own", "online")
    for name in half:
        (tmp_path / "own" / name).write_text("half")
        (tmp_path / "other" / name).write_text("mine")
    for name in ("own", "other"):
        claim_folder(tmp_path / name, "online")
    assert sorted(path.name for path in (tmp_path / "own").iterdir()) == [MANIFEST]
    assert sorted(path.name for path in (tmp_path / "other").iterdir()) == [*half, MANIFEST]


def test_a_damaged_manifest_says_so_and_can_be_overwritten(tmp_path):
    claim_folder(tmp_path, "online")
    (tmp_path / MANIFEST).write_text((tmp_path / MANIFEST).read_text().replace("online", "onlime"))
    with pytest.raises(InputError, match=r"is damaged; .*--overwrite"):
        claim_folder(tmp_path, "online")
    claim_folder(tmp_path, "online", overwrite=True)
    assert read_manifest(tmp_path).kind == "online"


def test_hidden_files_and_lost_and_found_do_not_count(tmp_path):
    for name in (".DS_Store", "lost+found"):
        (tmp_path / name).mkdir()
    write(tmp_path, {"a": "1"})
    assert content(tmp_path) == {"a": "1"}


def test_a_file_in_the_place_of_the_folder(tmp_path):
    (tmp_path / "out").write_text("mine")
    with pytest.raises(InputError, match="is a file"):
        write(tmp_path / "out", {})
    with pytest.raises(InputError, match="cannot be written"):
        write(tmp_path / "out" / "below", {})
    with pytest.raises(InputError, match="cannot be written"):
        write(tmp_path / ("n" * 300), {})
    assert (tmp_path / "out").read_text() == "mine"
    write(tmp_path / "other", {"a": "1"})
    with pytest.raises(InputError, match="stands where a folder has to be"):
        write(tmp_path / "other", {"a/b": "1"}, overwrite=True)
    assert content(tmp_path / "other") == {"a": "1"}


def test_json_has_no_nan(tmp_path):
    with pytest.raises(ValueError, match="JSON"):
        write_json(tmp_path / "a.json", {"auc": float("nan")})
    write_json(tmp_path / "a.json", {"auc": None})
    assert json.loads((tmp_path / "a.json").read_text()) == {"auc": None}
    assert [path.name for path in tmp_path.iterdir()] == ["a.json"]


def test_a_name_that_is_no_text_can_be_written_about(tmp_path):
    write_text(tmp_path / "a", os.fsdecode(b"image \xff.png"))
    assert (tmp_path / "a").read_text() == "image \\udcff.png"
    assert printable("a\x1b[2J\r\n\u202e" + os.fsdecode(b"\xff")) == "a\\x1b[2J\\r\\n\\u202e\\udcff"


def test_links_and_other_file_systems(tmp_path):
    other = Path("/dev/shm")
    if not other.is_dir() or other.stat().st_dev == tmp_path.stat().st_dev:
        pytest.skip("there is no second file system here")
    place = other / f"horizon-dl-test-{os.getpid()}"
    place.mkdir()
    try:
        (tmp_path / "link").symlink_to(place)
        write(tmp_path / "link", {"sub/a": "1"})
        assert content(place) == {"sub/a": "1"}
        write(tmp_path / "out", {"panels/a": "1"})
        shutil.rmtree(tmp_path / "out" / "panels")
        shutil.rmtree(place / "sub")
        (tmp_path / "out" / "panels").symlink_to(place)
        write(tmp_path / "out", {"panels/b": "2"}, overwrite=True)
        assert (place / "b").read_text() == "2"
    finally:
        shutil.rmtree(place)


@pytest.mark.parametrize("failing", range(1, 7))
def test_when_a_move_fails_all_go_back(tmp_path, monkeypatch, failing):
    out = tmp_path / "out"
    before = {"a": "1", "b": "1", "sub/c": "1", "gone": "1"}
    write(out, before)
    real, calls = stage.move, []

    def move(source, target):
        calls.append(source)
        if len(calls) == failing:
            raise OSError(errno.ENOSPC, "No space left on device")
        real(source, target)

    monkeypatch.setattr(stage, "move", move)
    with pytest.raises(InputError, match="No space left on device"):
        write(out, {"a": "2", "b": "2", "sub/c": "2", "new/d": "2"}, overwrite=True)
    assert content(out) == before
    assert not list(out.glob(".horizon-dl-*"))


def _die_at_move(out: Path, number: int) -> None:
    real, calls = stage.move, []

    def move(source, target):
        calls.append(source)
        if len(calls) == number:
            os.kill(os.getpid(), signal.SIGKILL)
        real(source, target)

    stage.move = move
    write(out, {"a": "2", "sub/c": "2", "new/d": "2"}, overwrite=True)


def test_a_kill_between_two_moves_is_undone_at_the_next_start(tmp_path):
    context = multiprocessing.get_context(
        "forkserver"
    )  # a fork of this process hangs on other threads' locks
    before = {"a": "1", "b": "1", "sub/c": "1"}
    for number in range(1, 8):
        out = tmp_path / f"out{number}"
        write(out, before)
        child = context.Process(target=_die_at_move, args=(out, number))
        child.start()
        child.join(30)
        assert child.exitcode == -signal.SIGKILL
        with pytest.raises(InputError, match="already"):
            write(out, {})
        assert content(out) == before
        assert not list(out.glob(".horizon-dl-*"))


def test_what_is_at_work_is_not_a_left_over(tmp_path):
    out = tmp_path / "out"
    with output_folder(out, "one") as folder:
        (folder / "a").write_text("1")
        write(out, {"b": "2"}, adding=True)
        assert (folder / "a").exists()
    assert content(out) == {"a": "1", "b": "2"}


def test_every_bit_of_a_manifest_counts(tmp_path):
    write(tmp_path / "out", {"a": "1"})
    path = tmp_path / "out" / MANIFEST
    whole = path.read_bytes()
    for bit in range(8 * len(whole)):
        damaged = bytearray(whole)
        damaged[bit // 8] ^= 1 << bit % 8
        path.write_bytes(damaged)
        with pytest.raises(InputError, match="damaged"):
            check_files(tmp_path / "out", ("a",), "make it again")
    path.write_bytes(whole)
    (tmp_path / "out" / "a").write_text("2")
    with pytest.raises(InputError, match=r"a: is damaged or was altered .*; make it again"):
        check_files(tmp_path / "out", ("a",), "make it again")


def test_a_full_disk_is_one_line(tmp_path):
    def fill(folder: Path) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    with (
        pytest.raises(InputError, match="No space left on device"),
        output_folder(tmp_path / "out") as folder,
    ):
        fill(folder)
    assert not (tmp_path / "out").exists()
    assert system_error(Exception("I/O error: (os error 28)")).errno == errno.ENOSPC
