"""Train the net on a data set, with the Lightning trainer.

  horizon-dl train DATA --out RUN
  horizon-dl train DATA --out RUN --train.rounds "[300, 400]" --target.kind guided

RUN then holds weights.safetensors, config.yaml, run.json and TensorBoard logs.
"""

import argparse

from horizon_dl.cli.fitness import add_force, stop_if_unfit
from horizon_dl.cli.options import add_config, add_data, add_out, open_data, resolve_config, say_skipped


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Options of the verb."""
    add_data(parser)
    add_config(parser)
    add_out(parser)
    add_force(parser)


def run(arguments: argparse.Namespace) -> None:
    """Train on all frames and write the run folder."""
    recording = open_data(arguments)
    config = resolve_config(arguments)
    stop_if_unfit(recording, config, force=arguments.force)

    from horizon_dl.output import output_folder
    from horizon_dl.training.run_folder import save_run
    from horizon_dl.training.train import train_run

    with output_folder(arguments.out) as folder:
        trained = train_run(recording, config, log_dir=folder / "tensorboard", progress=True)
        save_run(folder, trained)
    say_skipped(trained.info["skipped"])
    print(
        f"trained on {trained.info['frames']} frames of {recording.name} in {trained.info['train_s']:.0f} s"
    )
    print(f"wrote {arguments.out}; next: horizon-dl evaluate {arguments.out} {arguments.data} --out DIR")
