"""How fast model files are on this machine.

  horizon-dl benchmark MODEL.onnx                     times at 1 and 2 threads, and where they go
  horizon-dl benchmark DIR/*.onnx --out times.json    several files side by side, in one run

A file knows its camera, so it is timed at that camera's size; `horizon-dl export --size 160x120 --size
320x240 --size 640x480` writes a file for each further size.
"""

import argparse
from pathlib import Path
from typing import Any

from horizon_dl.cli.options import positive_int


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Options of the verb."""
    parser.add_argument("models", type=Path, nargs="+", metavar="MODEL.onnx", help="what `export` wrote")
    parser.add_argument("--out", type=Path, metavar="FILE", help="write the figures as JSON")
    parser.add_argument("--overwrite", action="store_true", help="replace FILE")
    parser.add_argument(
        "--threads", type=positive_int, nargs="+", default=[1, 2], metavar="N", help="default: 1 2"
    )
    parser.add_argument(
        "--runs", type=positive_int, default=100, metavar="N", help="timed runs (default: 100)"
    )


def run(arguments: argparse.Namespace) -> dict[str, Any]:
    """Measure, print the table, write the figures."""
    from horizon_dl.output.files import check_file, write_json
    from horizon_dl.runtime.benchmark import benchmark

    if arguments.out:
        check_file(arguments.out, arguments.overwrite)
    figures = benchmark(arguments.models, arguments.threads, arguments.runs)
    print(
        f"{figures['machine']['processor']}, onnxruntime {figures['versions']['onnxruntime']}, milliseconds"
    )
    for row in table(figures):
        print(row)
    if arguments.out:
        write_json(arguments.out, figures)
        print(f"wrote {arguments.out}")
    return figures


def table(figures: dict[str, Any]) -> list[str]:
    """A line a file and number of threads."""
    first = next(iter(figures["models"][0]["threads"].values()))
    stages = list(first["stages_ms"])
    head = ["image", "works at", "threads", "median", "quartiles", *stages, "JPEG decoding", "cold start"]
    rows = [head]
    for model in figures["models"]:
        for threads, found in model["threads"].items():
            rows.append(
                [
                    "x".join(map(str, model["image_size"])),
                    "x".join(map(str, model["working_size"])),
                    threads,
                    f"{found['median_ms']:.2f}",
                    f"{found['q1_ms']:.2f}-{found['q3_ms']:.2f}",
                    *(f"{found['stages_ms'][stage]:.2f}" for stage in stages),
                    f"{model['decode_jpeg_ms']:.2f}",
                    f"{1e3 * model['cold_start_s']:.0f}",
                ]
            )
    widths = [max(len(row[column]) for row in rows) for column in range(len(head))]
    return ["  ".join(cell.rjust(width) for cell, width in zip(row, widths, strict=True)) for row in rows]
