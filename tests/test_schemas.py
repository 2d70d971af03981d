"""The written files fit their schemas, and the docs hold the schemas as they are."""

import json
from pathlib import Path

import pytest
from small_run import small_export, small_run, toy_set
from tiny_online import tiny_run

from horizon_dl.errors import InputError
from horizon_dl.inspection.data_check import check_recording
from horizon_dl.readers.registry import open_recording
from horizon_dl.schemas.__main__ import FILES, schema_texts
from horizon_dl.schemas.card import Card
from horizon_dl.schemas.check import Check
from horizon_dl.schemas.frames import FrameLine
from horizon_dl.schemas.metrics import Metrics
from horizon_dl.schemas.run import RunInfo

DOCS = Path(__file__).parents[1] / "docs" / "schemas"


def test_the_docs_hold_every_schema_as_it_is() -> None:
    for name, text in schema_texts().items():
        assert (DOCS / name).read_text() == text, f"run: python -m horizon_dl.schemas {DOCS}"


def test_what_a_run_and_an_export_write_fits() -> None:
    assert RunInfo.parse(small_run().info, "run.json").threshold == small_run().threshold
    assert Card.parse(small_export().card, "card.json").learner == "cnn"


def test_what_an_online_run_writes_fits(tmp_path: Path) -> None:
    run = tiny_run(toy_set(), tmp_path / "run")
    run.run()
    run.finish()
    assert Metrics.read(tmp_path / "run" / "metrics.json").protocol == "prequential"
    assert RunInfo.read(tmp_path / "run" / "run.json").format == "images_csv"
    for line in (tmp_path / "run" / "frames.jsonl").read_text().splitlines():
        FrameLine.parse(json.loads(line), "frames.jsonl")


def test_what_a_check_writes_fits() -> None:
    check = check_recording(open_recording(toy_set()), max_frames=4)
    assert Check.parse(json.loads(json.dumps(check.to_json())), "check.json").level in (
        "ok",
        "warning",
        "problem",
    )


@pytest.mark.parametrize("file", FILES, ids=lambda one: one.FILE)
def test_another_version_or_content_is_one_line(file, tmp_path: Path) -> None:
    path = tmp_path / file.FILE
    for text, words in (
        ('{"schema": 99}', "99"),
        ("[1, 2]", "version"),
        ("{}" if file is not Metrics else '{"schema": 1}', "key"),
        ("{", "JSON"),
        ("[" * 100_000, "JSON"),
    ):
        path.write_text(text)
        with pytest.raises(InputError, match=words) as caught:
            file.read(path)
        assert "\n" not in str(caught.value)
