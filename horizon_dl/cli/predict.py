"""Pictures, arrays, a film and a page from a trained net, or from the ONNX file it was exported to.

  horizon-dl predict RUN DATA --out DIR           a data set: with horizon, and truth where there is one
  horizon-dl predict RUN pictures/ --out DIR      a folder of images, or one image
  horizon-dl predict MODEL.onnx DATA --out DIR    without torch; the images must be the model's camera's

DIR then holds index.html, film.mp4 (H.264; needs the extra `logs`), panels/NAME.jpg and arrays/NAME.npz
(p_above, entropy, ... at the working size). Of more than 1000 frames panels and arrays are written of every
Nth only; the film shows ten pictures a second at most. A camera is predicted until Ctrl-C or --max-frames.
"""

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

from horizon_dl.cli.data_options import add_data, given
from horizon_dl.cli.options import add_out, add_vehicle_height, positive_int, say_skipped

if TYPE_CHECKING:
    from horizon_dl.data.source import FrameSource
    from horizon_dl.reporting.run_page import Page
    from horizon_dl.runtime.prediction import Predictor


MOST_PANELS = 1000
NO_ATTITUDE = "without an attitude there is no horizon: nothing is called free, and there are no distances"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Options of the verb."""
    parser.add_argument("model", type=Path, metavar="MODEL", help="what `train --out` or `export` wrote")
    add_data(parser, "source")
    parser.add_argument("--video", type=Path, metavar="FILE", help="also a copy of the film")
    parser.add_argument("--max-frames", type=positive_int, metavar="N", help="end after N frames")
    parser.add_argument(
        "--every",
        type=positive_int,
        metavar="N",
        help="panels and arrays of every Nth frame (default: so that there are at most 1000)",
    )
    add_vehicle_height(parser)
    add_out(parser)


def run(arguments: argparse.Namespace) -> dict[str, Any]:
    """Predict frame by frame and write as it goes."""
    from horizon_dl.errors import InputError
    from horizon_dl.methods.open_predictor import is_model_file, open_predictor
    from horizon_dl.output.files import check_file
    from horizon_dl.training.run_files import check_run_folder

    if arguments.video is not None:
        check_file(arguments.video, arguments.overwrite, "--video")
    if not is_model_file(arguments.model):
        check_run_folder(arguments.model)

    from horizon_dl.output import output_folder, write_bytes
    from horizon_dl.reporting.outputs import can_film
    from horizon_dl.reporting.run_page import FILM
    from horizon_dl.sources.open_source import open_source

    beside = given(arguments, needs_attitude=False)
    source = open_source(arguments.source, arguments.format, beside)
    predictor = open_predictor(arguments.model)
    predictor.check(source)
    if arguments.video and not can_film():
        raise InputError("--video", "needs av", "pip install 'horizon-dl[logs]'")
    _say_without_height(arguments, source)
    _say_without_attitude(arguments, source)
    length = _length(arguments, source)
    every = arguments.every or every_nth(length)
    if every > 1:
        print(f"panels and arrays of 1 in {every} frames; --every 1 writes all")
    with output_folder(arguments.out, "predict", overwrite=arguments.overwrite) as folder:
        count, skipped = _predict(arguments, predictor, source, folder, every)
        if not count:
            first = next(iter(skipped.values()), "it is empty")
            raise InputError(arguments.source, "holds no frame that can be used", first)
        film = (folder / FILM).is_file()
        if arguments.video and film:
            write_bytes(arguments.video, (folder / FILM).read_bytes())
    say_skipped(skipped)
    note = predictor.note()
    if predictor.doubt:
        print(f"the net says of itself: {predictor.doubt}")
    if note:
        print(f"note: {note}")
    _say_written(arguments, count, every, film)
    return {"out": arguments.out, "frames": count, "skipped": skipped, "note": note}


def _say_written(arguments: argparse.Namespace, count: int, every: int, film: bool) -> None:
    from horizon_dl.reporting.outputs import NO_FILM, can_film

    print(f"wrote {-(-count // every)} panels and arrays to {arguments.out}")
    if arguments.video and film:
        print(f"wrote {count} frames to {arguments.video}")
    if not can_film():
        print(NO_FILM)
    print(f"look at {arguments.out / 'index.html'}")


def every_nth(length: int | None) -> int:
    """Of which frames panels and arrays are written: each is some 100 KB, and a film soon has 20,000 frames.

    Example:
        >>> every_nth(1000), every_nth(1001), every_nth(18000), every_nth(None)
        (1, 2, 18, 1)
    """
    return 1 if length is None else max(1, -(-length // MOST_PANELS))


def _say_without_attitude(arguments: argparse.Namespace, source: "FrameSource") -> None:
    """InputError where the attitude that was given cannot be used."""
    from horizon_dl.errors import InputError

    if not _lacks_attitude(source):
        return
    if arguments.attitude is not None and source.camera is None:
        problem = "needs to know the camera"
        raise InputError(f"--attitude {arguments.attitude}", problem, "give --camera FILE")
    lacking = "--attitude gives one" if source.camera else "--camera and --attitude give one"
    print(f"note: {NO_ATTITUDE}; {lacking}")


def _say_without_height(arguments: argparse.Namespace, source: "FrameSource") -> None:
    from horizon_dl.data.source import Recording

    asked = arguments.vehicle_height is not None and arguments.vehicle_height.below_m > 0
    if asked and isinstance(source, Recording) and all(one.height_m is None for one in source.headers):
        print("no height of the camera is known: --vehicle-height lets nothing pass, all obstacles block")


def _lacks_attitude(source: "FrameSource") -> bool:
    """Whether it is clear beforehand that no frame has an attitude."""
    from horizon_dl.data.source import Recording

    return isinstance(source, Recording) and all(one.up_cam is None for one in source.headers)


def _length(arguments: argparse.Namespace, source: "FrameSource") -> int | None:
    lengths = [n for n in (source.length, arguments.max_frames) if n is not None]
    return min(lengths, default=None)


def _predict(
    arguments: argparse.Namespace, predictor: "Predictor", source: "FrameSource", folder: Path, every: int
) -> tuple[int, dict[str, str]]:
    from itertools import islice

    from horizon_dl.cli.stopping import stopping
    from horizon_dl.data.source import Recording
    from horizon_dl.output.names import ResultNames
    from horizon_dl.progress import show_progress
    from horizon_dl.reporting.outputs import film_and_page
    from horizon_dl.visualization.file_sinks import Arrays, Panels
    from horizon_dl.visualization.log_predictions import log_predictions
    from horizon_dl.visualization.sink import EveryNth, Sink, closing

    names = [one.name for one in source.headers] if isinstance(source, Recording) else []
    title = f"{predictor.name} on {source.name}"
    sinks: list[Sink] = [
        EveryNth(Panels(folder / "panels", ResultNames(names)), every),
        EveryNth(Arrays(folder / "arrays", ResultNames(names)), every),
        *film_and_page(folder, source, title, lambda page: _lead(page, predictor, source)),
    ]
    frames = islice(source.frames(), arguments.max_frames)
    bar = show_progress(frames, "predict", total=_length(arguments, source), unit="frame")
    with closing(sinks) as sink, stopping(source.stop) as stopped:
        return log_predictions(predictor, bar, sink, stopped, arguments.vehicle_height)


def _lead(page: "Page", predictor: "Predictor", source: "FrameSource") -> str:
    """What was done, and on frames of what."""
    from statistics import fmean

    words = f"{predictor.name} looked at {page.frames} frame{'s' * (page.frames != 1)} of {source.name}."
    if page.aucs:
        auc = fmean(value for _, value in page.aucs)
        words += f" On the {len(page.aucs)} with truth the AUC of its obstacles is {auc:.3f} in the mean."
    if predictor.trained_on == source.name:
        words += " It was trained on these frames, or on frames of the same place: expect less elsewhere."
    if predictor.doubt:
        words += f" The net says of itself: {predictor.doubt}."
    note = predictor.note()
    if note:
        words += f" {note[0].upper()}{note[1:]}."
    if source.camera is None or _lacks_attitude(source):
        words += f" {NO_ATTITUDE[0].upper()}{NO_ATTITUDE[1:]}."
    return words
