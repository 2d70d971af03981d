"""Labels of images with equal stems."""

from pathlib import Path

import make_sets
import numpy as np
from PIL import Image

from horizon_dl.readers.registry import open_recording


def save_label(path: Path, value: int) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    Image.fromarray(np.full((24, 32), value, np.uint8)).save(path)


def test_two_images_of_one_stem_do_not_share_a_label(tmp_path):
    rows = ["a/1.png,0.0,0.1,0.0,0.0,1.5", "b/1.png,0.1,0.0,0.2,0.0,1.4"]
    folder = make_sets.images_csv(tmp_path, rows)
    save_label(folder / "labels" / "1.png", 1)
    assert not any(header.labelled for header in open_recording(folder).headers)
    save_label(folder / "labels" / "a" / "1.png", 2)
    recording = open_recording(folder)
    assert [header.labelled for header in recording.headers] == [True, False]
    assert recording.read(0).truth.max() == 2


def test_a_label_is_found_by_its_stem_alone_where_that_is_clear(tmp_path):
    folder = make_sets.images_csv(tmp_path)
    save_label(folder / "labels" / "a.png", 3)
    assert [header.labelled for header in open_recording(folder).headers] == [True, False]
