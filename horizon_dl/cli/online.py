"""Learn from a stream in one pass: every frame is predicted, then learned from; resumable at any time.

  horizon-dl online DATA --out RUN                          a recorded set, as fast as it goes
  horizon-dl online DATA --out RUN --real-time              its frames at the times at which they were taken
  horizon-dl online FILM.mp4 --attitude LOG.csv --camera camera.yaml --out RUN
                                                            LOG: time_s,roll_rad,pitch_rad,yaw_rad
  horizon-dl online camera:0 --mavlink udpin:127.0.0.1:14551 --camera camera.yaml --out RUN
                                                            a camera, with the autopilot's attitude

RUN then holds index.html, film.mp4, frames.jsonl (one line a frame), TensorBoard logs, a checkpoint, and all
of a run folder, with metrics.json. --serve, --show and --rerun let it be watched. Stopped or killed,
the same command goes on where the last checkpoint was taken.
"""

import argparse
from typing import TYPE_CHECKING, Any

from horizon_dl.cli.data_options import add_data, given
from horizon_dl.cli.fitness import add_force, stop_if_unfit
from horizon_dl.cli.next_command import data_words, next_command
from horizon_dl.cli.options import (
    add_autopilot,
    add_config,
    add_out,
    add_sign,
    check_autopilot,
    positive_int,
    resolve_config,
    signer,
)
from horizon_dl.cli.stopping import stopping
from horizon_dl.cli.viewers import add_viewers

if TYPE_CHECKING:
    from horizon_dl.data.source import FrameSource
    from horizon_dl.online.run import OnlineRun


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Options of the verb."""
    add_data(parser)
    add_config(parser)
    add_out(parser)
    add_force(parser)
    parser.add_argument("--restart", action="store_true", help="do not go on from the checkpoint in RUN")
    parser.add_argument(
        "--max-frames", type=positive_int, metavar="N", help="end after the stream's first N frames"
    )
    parser.add_argument(
        "--export-every",
        type=positive_seconds,
        metavar="S",
        help="write a fresh RUN/model.onnx every S seconds; a running `fly` takes it over",
    )
    add_sign(parser)
    parser.add_argument(
        "--real-time",
        action="store_true",
        help="predict frames as they come, learn from the newest when there is time",
    )
    parser.add_argument("--speed", type=positive_seconds, metavar="X", help="of --real-time (default: 1)")
    parser.add_argument("--mavlink", metavar="URL", help="as --attitude mavlink:URL")
    parser.add_argument("--no-film", action="store_true", help="leave no film and no page")
    add_viewers(parser)
    add_autopilot(parser)


def positive_seconds(text: str) -> float:
    """For argparse: a positive number."""
    value = float(text)
    if not 0 < value < float("inf"):
        raise argparse.ArgumentTypeError("must be positive")
    return value


def run(arguments: argparse.Namespace) -> dict[str, Any]:
    """Learn until the stream ends, Ctrl-C or SIGTERM; then write the run folder."""
    source = _source(arguments)
    config = resolve_config(arguments)
    stop_if_unfit(source, config, force=arguments.force)

    from horizon_dl.cli.online_views import open_views
    from horizon_dl.errors import InputError
    from horizon_dl.online.real_time import run_in_real_time
    from horizon_dl.online.run import OnlineRun

    if arguments.speed is not None and (source.live or not arguments.real_time):
        raise InputError("--speed", "has no meaning without --real-time, nor with --mavlink", "leave it out")
    if arguments.sign is not None and arguments.export_every is None:
        raise InputError("--sign", "has no meaning without --export-every", "leave it out")
    online = OnlineRun(
        source,
        config,
        arguments.out,
        max_frames=arguments.max_frames,
        export_every_s=arguments.export_every,
        sign=signer(arguments.sign),
        restart=arguments.restart,
        overwrite=arguments.overwrite,
        progress=True,
    )
    if online.position:
        online.keeper.say(f"going on at frame {online.position} of {source.name}")
    open_views(arguments, online)
    more: dict[str, Any] = {}
    with stopping(online.stop):
        if arguments.real_time or source.live:
            more = {"real_time": run_in_real_time(online, arguments.speed or 1.0)}
        else:
            online.run()
    online.finish(**more)
    _say(arguments, online, more)
    pooled, within = online.figures.auc()
    counts = {**online.figures.counts(), "auc": pooled, "auc_within_depression": within, **more}
    return {"out": arguments.out, "data": source.name, "stopped": online.stopped, **counts}


def _source(arguments: argparse.Namespace) -> "FrameSource":
    from horizon_dl.data.given import MAVLINK
    from horizon_dl.errors import InputError
    from horizon_dl.sources.open_source import open_source
    from horizon_dl.vehicle.mavlink import open_link

    if arguments.mavlink and arguments.attitude:
        raise InputError("--attitude", "has no meaning with --mavlink", "leave one of them out")
    if arguments.mavlink:
        arguments.attitude = MAVLINK + arguments.mavlink
    autopilot = arguments.attitude is not None and arguments.attitude.startswith(MAVLINK)
    if not autopilot and (arguments.camera_delay or arguments.system != 1 or arguments.signing_key):
        options = "--camera-delay, --system or --signing-key"
        raise InputError(options, "has no meaning without an autopilot", "give --attitude mavlink:URL")
    check_autopilot(arguments)
    return open_source(
        arguments.data,
        arguments.format,
        given(arguments),
        delay_s=arguments.camera_delay,
        link=lambda url: open_link(url, arguments.system, arguments.signing_key),
    )


def _say(arguments: argparse.Namespace, online: "OnlineRun", more: dict[str, Any]) -> None:
    figures, name = online.figures, online.source.name
    print(f"saw {figures.seen} frames of {name}, learned from {figures.learned}")
    for reason, count in figures.reasons.most_common():
        print(f"  not learned from: {count}, {reason}")
    if online.learner.dropped:
        print(f"  steps dropped, loss or gradient not finite: {online.learner.dropped}")
    if online.keeper.failed:
        print(f"  checkpoints that could not be written: {online.keeper.failed}")
    if more:
        timing = more["real_time"]
        print(f"from arrival to prediction: median {timing['median_ms']} ms, 99 % in {timing['p99_ms']} ms")
    pooled, within = online.figures.auc()
    if pooled is not None and within is not None:
        print(f"AUC of the entropy, before learning: {pooled:.3f}, within depression bands {within:.3f}")
    rest = " (stopped; the same command goes on)" if online.stopped else ""
    data = ["DATA"] if online.source.live else data_words(arguments)
    print(f"wrote {arguments.out}{rest}; {next_command('evaluate', arguments.out, *data, '--out', 'DIR')}")
