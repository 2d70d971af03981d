"""Write a trained net as one ONNX file that a drone's CPU runs.

  horizon-dl export RUN --out DIR                     for the camera it was trained with
  horizon-dl export RUN --out DIR --data DATA         compare and measure on real frames, too
  horizon-dl export RUN --out DIR --camera DATA       for the camera of another data set
  horizon-dl export RUN --out DIR --size 320x240      also for images resized to that size (repeatable)
  horizon-dl export RUN --out DIR --data DATA --int8  also in whole numbers, with what that costs and gains
  horizon-dl export RUN --out DIR --forest DATA       also the paper's forest, fitted on DATA, for comparison

DIR then holds model.onnx, card.json and parity.json; further sizes are model-WxH.onnx, the forest is
forest.onnx. A file takes the camera's image and attitude and gives probability, uncertainties and the
obstacle map. It is flown by the sections contact, ranging, evidence and flight of the run's config;
--contact.rise 0.9 and the like change them in the file. The forest's file is used like the net's; it takes
many times as long, and its card says so.
"""

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

from horizon_dl.cli.next_command import next_command
from horizon_dl.cli.options import add_out, add_sign, add_values, signer

if TYPE_CHECKING:
    from horizon_dl.config import Config
    from horizon_dl.data.source import Recording
    from horizon_dl.export.export import Exported
    from horizon_dl.geometry.camera import Camera


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Options of the verb."""
    parser.add_argument("run_folder", type=Path, metavar="RUN", help="what `train --out` wrote")
    add_out(parser)
    parser.add_argument("--data", type=Path, metavar="DATA", help="data set to compare and measure on")
    parser.add_argument("--camera", type=Path, metavar="DATA", help="data set whose camera the file is for")
    parser.add_argument(
        "--size", type=image_size, metavar="WxH", action="append", default=[], help="a further image size"
    )
    parser.add_argument("--int8", action="store_true", help="also write model-int8.onnx (needs --data)")
    parser.add_argument(
        "--forest", type=Path, metavar="DATA", help="fit the forest on this set, too, and write forest.onnx"
    )
    add_sign(parser)
    parser.add_argument("--format", metavar="NAME", help="format of DATA (recognised if left out)")
    add_values(parser, "contact", "ranging", "evidence", "flight")


def image_size(text: str) -> tuple[int, int]:
    """For argparse: `320x240` as (320, 240)."""
    width, _, height = text.partition("x")
    if not (width.isdigit() and height.isdigit() and min(int(width), int(height)) >= 8):
        raise argparse.ArgumentTypeError("write it as WIDTHxHEIGHT in pixels, such as 320x240")
    return int(width), int(height)


def run(arguments: argparse.Namespace) -> dict[str, Any]:
    """Export, compare, measure, write."""
    from horizon_dl.training.run_files import check_run_folder

    check_run_folder(arguments.run_folder)
    from dataclasses import replace

    from horizon_dl.config import changed_config
    from horizon_dl.errors import InputError
    from horizon_dl.export.export import export_run, parity_frames, trained_camera
    from horizon_dl.output import output_folder
    from horizon_dl.readers.registry import open_recording
    from horizon_dl.runtime.predict import same_camera
    from horizon_dl.training.run_folder import load_run

    if arguments.int8 and not arguments.data:
        raise InputError("--int8", "is chosen by measuring", "name a data set with --data")
    trained = load_run(arguments.run_folder)
    trained = replace(trained, config=changed_config(trained.config, arguments.overrides))
    data = open_recording(arguments.data, arguments.format) if arguments.data else None
    if arguments.camera:
        camera = open_recording(arguments.camera, arguments.format).calibrated
    else:
        camera = trained_camera(trained, arguments.run_folder)
    if data and not same_camera(data.calibrated, camera):
        raise InputError(
            arguments.data, "has another camera than the file would", "add --camera with that set"
        )
    forest_data = open_recording(arguments.forest, arguments.format) if arguments.forest else None
    if data and forest_data and not same_camera(data.calibrated, forest_data.calibrated):
        raise InputError(arguments.forest, "has another camera than --data", "leave --data away")
    sign = signer(arguments.sign)
    with output_folder(arguments.out, "export", overwrite=arguments.overwrite) as folder:
        exported = export_run(trained, camera, parity_frames(data) if data else ()).signed(sign)
        exported = _measured(exported, data)
        exported.write(folder)
        _say(exported)
        if arguments.int8 and data:
            _write_int8(folder, exported, data)
        if forest_data:
            _write_forest(folder, exported, forest_data, trained.config, data)
        for width, height in arguments.size:
            resized = export_run(trained, _resized(camera, width, height)).signed(sign)
            resized.write(folder, f"model-{width}x{height}")
    print(f"wrote {arguments.out}; {next_command('benchmark', arguments.out / 'model.onnx')}")
    return {"out": arguments.out, "card": exported.card}


def _measured(exported: "Exported", data: "Recording | None") -> "Exported":
    from horizon_dl.export.measure import measured

    if data is None or not any(entry.labelled for entry in data.headers):
        return exported
    figures = measured(exported.content(), data)
    return exported.with_card(measured=figures, false_positive_rate=figures["fpr"])


def _write_int8(folder: Path, exported: "Exported", data: "Recording") -> None:
    from horizon_dl.export.int8 import write_int8

    for line in write_int8(folder, exported, data):
        print(line)


def _write_forest(
    folder: Path, net: "Exported", recording: "Recording", config: "Config", data: "Recording | None"
) -> None:
    from horizon_dl.export.forest import cost_line, export_forest, with_cost

    forest = with_cost(_measured(export_forest(recording, config), data), net).signed(net.sign)
    forest.write(folder, "forest")
    _say(forest)
    print(cost_line(forest.card["cost"]))


def _resized(camera: "Camera", width: int, height: int) -> "Camera":
    from horizon_dl.errors import InputError

    if abs(width * camera.height / (height * camera.width) - 1) > 0.02:
        problem = f"has another aspect than the camera's {camera.width}x{camera.height}"
        raise InputError(f"--size {width}x{height}", problem, "take a multiple of that")
    return camera.scaled(width, height)


def _say(exported: "Exported") -> None:
    figures = exported.card["parity"]
    worst = max(level["p_above"] for level in figures["levels"].values())
    frames = f"{figures['frames']} {figures['on']}"
    print(f"parity on {frames}: p_above within {worst:.1e} at every optimisation level")
    if "measured" in exported.card:
        found = exported.card["measured"]
        rates = f"TPR {found['tpr']:.3f}, FPR {found['fpr']:.3f}"
        print(f"on {found['data']}: AUC {found['auc']:.3f}, at the threshold {rates}")
