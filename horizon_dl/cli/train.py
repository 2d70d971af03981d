"""Train the net on a data set, with the Lightning trainer.

  horizon-dl train DATA --out RUN
  horizon-dl train DATA --out RUN --train.rounds "[300, 400]" --target.kind guided

RUN then holds weights.safetensors, config.yaml, run.json, TensorBoard logs, and index.html with film.mp4:
what the net says of the frames it has learned from. Every minute, and when it is stopped by Ctrl-C or
SIGTERM, the training (in one process) leaves a checkpoint there; the same command with --resume goes on from
it, to the same weights.
"""

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

from horizon_dl.cli.data_options import add_data, open_data
from horizon_dl.cli.fitness import add_force, stop_if_unfit
from horizon_dl.cli.next_command import data_words, next_command
from horizon_dl.cli.options import add_config, add_out, resolve_config, say_skipped
from horizon_dl.cli.stopping import stopping

if TYPE_CHECKING:
    from horizon_dl.data.source import Recording
    from horizon_dl.training.run_folder import Run

MOST_SHOWN = 120
"""Frames in the film of a training."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Options of the verb."""
    add_data(parser)
    add_config(parser)
    add_out(parser)
    add_force(parser)
    parser.add_argument(
        "--resume", action="store_true", help="go on from the checkpoint that a stopped training left in RUN"
    )


def run(arguments: argparse.Namespace) -> dict[str, Any]:
    """Train on all frames and write the run folder; Ctrl-C and SIGTERM leave a checkpoint."""
    from horizon_dl.output.folder import check_free

    if not (arguments.resume or arguments.overwrite):
        check_free(arguments.out)
    recording = open_data(arguments)
    config = resolve_config(arguments)
    stop_if_unfit(recording, config, force=arguments.force)

    from horizon_dl.errors import printable
    from horizon_dl.evaluation.round_log import log_round
    from horizon_dl.evidence.self_assessment import said
    from horizon_dl.output import output_folder
    from horizon_dl.training.resumable import KIND, TrainingKeeper
    from horizon_dl.training.run_folder import save_run
    from horizon_dl.training.train import train_run

    keeper = TrainingKeeper(
        arguments.out, recording, config, resume=arguments.resume, overwrite=arguments.overwrite
    )
    replace = {"overwrite": arguments.overwrite, "adding": arguments.resume}
    with output_folder(arguments.out, KIND, **replace) as folder:
        with stopping(keeper.stop):
            trained = train_run(
                recording, config, log_dir=folder, progress=True, keeper=keeper, after_round=log_round
            )
        save_run(folder, trained)
        _show(folder, trained, recording)
    keeper.finish()
    say_skipped(trained.info["skipped"])
    name = printable(recording.name)
    print(f"trained on {trained.info['frames']} frames of {name} in {trained.info['train_s']:.0f} s")
    doubt = said(trained.info["self_assessment"])
    if doubt is not None:
        print(f"the net says of itself: {doubt}")
    print(f"look at {arguments.out / 'index.html'}")
    verb = "evaluate" if any(header.labelled for header in recording.headers) else "predict"
    hint = next_command(verb, arguments.out, *data_words(arguments), "--out", "DIR")
    print(f"wrote {arguments.out}; {hint}")
    told = (
        "frames",
        "start",
        "train_s",
        "threshold",
        "threshold_rule",
        "simulated_threshold",
        "skipped",
        "self_assessment",
        "path_agreement",
        "deep_share",
    )
    return {"out": arguments.out, "data": recording.name, **{key: trained.info[key] for key in told}}


def _show(folder: Path, trained: "Run", recording: "Recording") -> None:
    """A film and a page of frames that it was trained on."""
    from horizon_dl.data.evenly import evenly
    from horizon_dl.processes import is_helper
    from horizon_dl.reporting.outputs import film_and_page
    from horizon_dl.training.predict import RunPredictor
    from horizon_dl.visualization.log_predictions import log_predictions
    from horizon_dl.visualization.sink import closing

    if is_helper():
        return
    predictor = RunPredictor(trained)
    part = recording.select(evenly(range(recording.length), MOST_SHOWN))
    start = ", from a start taught in simulated worlds" if trained.info["start"] == "simulated" else ""
    lead = (
        f"The net was trained on {trained.info['frames']} frames of {recording.name}, without any label of "
        f"them{start}. The "
        f"frames below are of the same recording: what it is worth elsewhere, `evaluate` says."
    )
    if predictor.doubt:
        lead += f" The net says of itself: {predictor.doubt}."
    facts = [
        ("threshold", f"{trained.threshold:.3f} ({trained.info['threshold_rule']})"),
        ("training", f"{trained.info['train_s']:.0f} s"),
        ("frames left out", str(len(trained.info["skipped"]))),
    ]
    title = f"Trained on {recording.name}"
    with closing(film_and_page(folder, part, title, lambda _: lead, lambda: facts)) as sink:
        log_predictions(predictor, part.frames(), sink)
