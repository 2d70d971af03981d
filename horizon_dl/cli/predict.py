"""Panels and arrays from a trained net, or from the ONNX file it was exported to.

  horizon-dl predict RUN DATA --out DIR           a data set: with horizon, and truth where there is one
  horizon-dl predict RUN pictures/ --out DIR      a folder of images, or one image
  horizon-dl predict MODEL.onnx DATA --out DIR    without torch; the images must be the model's camera's

DIR then holds panels/NAME.jpg and arrays/NAME.npz (p_above, entropy, ... at the working size).
"""

import argparse
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from horizon_dl.cli.options import add_data, add_out, given, is_model_file, say_skipped

if TYPE_CHECKING:
    from horizon_dl.data.source import Recording
    from horizon_dl.errors import FrameError
    from horizon_dl.visualization.colours import Image

    Drawn = tuple[str, Image, dict[str, Any]]


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Options of the verb."""
    parser.add_argument("model", type=Path, metavar="MODEL", help="what `train --out` or `export` wrote")
    add_data(parser, "source")
    parser.add_argument(
        "--video",
        type=Path,
        metavar="FILE",
        help="also an MP4 with distance per bearing (MODEL.onnx, data set)",
    )
    add_out(parser)


def run(arguments: argparse.Namespace) -> None:
    """Predict frame by frame and write as it goes."""
    import numpy as np
    from tqdm import tqdm

    from horizon_dl.data.open_source import finished_recording, open_source
    from horizon_dl.errors import FrameError, InputError
    from horizon_dl.output import output_folder
    from horizon_dl.output.names import ResultNames
    from horizon_dl.training.run_files import check_run_folder
    from horizon_dl.visualization.panels import save_panel

    _check_film(arguments.video, arguments.overwrite)
    if not is_model_file(arguments.model):
        check_run_folder(arguments.model)
    predictions = _from_file if is_model_file(arguments.model) else _from_run
    wanted = given(arguments, needs_attitude=False)
    recording = finished_recording(open_source(arguments.source, arguments.format, wanted))
    if arguments.video and not (is_model_file(arguments.model) and recording.camera):
        raise InputError("--video", "needs an exported model and a camera", "run `horizon-dl export`")
    count = recording.length
    skipped: dict[str, str] = {}
    names = ResultNames([header.name for header in recording.headers])
    with output_folder(arguments.out, "predict", overwrite=arguments.overwrite) as folder:
        for item in tqdm(predictions(arguments.model, recording), "predict", total=count, unit="frame"):
            if isinstance(item, FrameError):
                skipped[str(item)] = str(item)
                continue
            name, panel, arrays = item
            result = names(name)
            save_panel(folder / "panels" / f"{result}.jpg", panel)
            place = folder / "arrays" / f"{result}.npz"
            place.parent.mkdir(parents=True, exist_ok=True)
            np.savez_compressed(place, **arrays)
        if len(skipped) == count:
            raise InputError(
                arguments.source, "holds no frame that can be used", next(iter(skipped.values()))
            )
    say_skipped(skipped)
    print(f"wrote {count - len(skipped)} panels and arrays to {arguments.out}")
    if arguments.video:
        print(f"wrote {_film(arguments.video, arguments.model, recording)} frames to {arguments.video}")


def _check_film(path: Path | None, overwrite: bool) -> None:
    from horizon_dl.output.files import check_file

    if path is not None:
        check_file(path, overwrite, "--video")


def _film(path: Path, model: Path, recording: "Recording") -> int:
    from horizon_dl.runtime.model import ObstacleModel
    from horizon_dl.visualization.video import write_film

    return write_film(path, ObstacleModel.load(model), recording)


def _from_run(folder: Path, recording: "Recording") -> "Iterator[Drawn | FrameError]":
    from horizon_dl.data.frame import checked
    from horizon_dl.errors import FrameError
    from horizon_dl.reporting.comparison import prediction_panel
    from horizon_dl.training.evidence import place_of
    from horizon_dl.training.predict import predict
    from horizon_dl.training.run_folder import load_run

    trained = load_run(folder)
    place = place_of(trained.info, folder)
    for item in recording.frames():
        try:
            if isinstance(item, FrameError):
                raise item
            prediction = predict(trained, checked(item))
        except FrameError as error:
            yield error
            continue
        yield item.name, prediction_panel(prediction, item, trained.threshold, place), prediction.arrays()


def _from_file(path: Path, recording: "Recording") -> "Iterator[Drawn | FrameError]":
    from horizon_dl.errors import FrameError
    from horizon_dl.runtime.model import ObstacleModel
    from horizon_dl.runtime.predict import predict_source

    for item in predict_source(ObstacleModel.load(path), recording):
        yield item if isinstance(item, FrameError) else (item.frame.name, item.panel(), item.arrays())
