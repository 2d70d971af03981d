"""Panels and arrays from a trained net.

  horizon-dl predict RUN DATA --out DIR           a data set: with horizon, and truth where there is one
  horizon-dl predict RUN pictures/ --out DIR      a folder of images, or one image

DIR then holds panels/NAME.jpg and arrays/NAME.npz (p_above, entropy, ... at the working size).
"""

import argparse
from pathlib import Path

from horizon_dl.cli.options import add_out, say_skipped


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Options of the verb."""
    parser.add_argument("model", type=Path, metavar="MODEL", help="what `train --out` wrote")
    parser.add_argument("source", type=Path, metavar="SOURCE", help="data set, folder of images, or image")
    parser.add_argument("--format", metavar="NAME", help="format of SOURCE (recognised if left out)")
    add_out(parser)


def run(arguments: argparse.Namespace) -> None:
    """Predict frame by frame and write as it goes."""
    import numpy as np
    from tqdm import tqdm

    from horizon_dl.errors import FrameError, InputError
    from horizon_dl.frames.frame import Recording
    from horizon_dl.learning.predict import open_source, predict, views_of
    from horizon_dl.learning.run import load_run
    from horizon_dl.output import output_folder
    from horizon_dl.reporting.comparison import prediction_panel
    from horizon_dl.reporting.panels import save_panel

    trained = load_run(arguments.model)
    source = open_source(arguments.source, arguments.format)
    count = len(source.entries) if isinstance(source, Recording) else len(source)
    skipped: dict[str, str] = {}
    with output_folder(arguments.out) as folder:
        (folder / "arrays").mkdir()
        items = views_of(source, trained.config.image.max_pixels)
        for item in tqdm(items, "predict", total=count, unit="frame"):
            if isinstance(item, FrameError):
                skipped[str(item)] = str(item)
                continue
            prediction = predict(trained, *item)
            stem = Path(prediction.view.name).stem
            save_panel(folder / "panels" / f"{stem}.jpg", prediction_panel(prediction))
            np.savez_compressed(folder / "arrays" / f"{stem}.npz", **prediction.arrays())
        if len(skipped) == count:
            first = next(iter(skipped.values()))
            raise InputError(arguments.source, f"holds no readable frame (the first: {first})", "mend it")
    say_skipped(skipped)
    print(f"wrote {count - len(skipped)} panels and arrays to {arguments.out}")
