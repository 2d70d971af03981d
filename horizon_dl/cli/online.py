"""Learn from a stream in one pass: every frame is predicted, then learned from; resumable at any time.

  horizon-dl online DATA --out RUN                          a recorded set, as fast as it goes
  horizon-dl online DATA --out RUN --real-time              its frames at the times at which they were taken
  horizon-dl online FILM.mp4 --attitude LOG.csv --camera camera.yaml --out RUN
                                                            LOG: time_s,roll_rad,pitch_rad,yaw_rad
  horizon-dl online camera:0 --mavlink udpin:127.0.0.1:14551 --camera camera.yaml --out RUN
                                                            a camera, with the autopilot's attitude

RUN then holds frames.jsonl (one line a frame), TensorBoard logs, a checkpoint, and all of a run folder, with
metrics.json. Stopped or killed, the same command goes on where the last checkpoint was taken.
"""

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

from horizon_dl.cli.options import (
    add_autopilot,
    add_config,
    add_format,
    add_out,
    check_autopilot,
    positive_int,
    resolve_config,
)

if TYPE_CHECKING:
    from horizon_dl.data.capture.stream import Stream
    from horizon_dl.data.frame import Recording
    from horizon_dl.online.run import OnlineRun


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Options of the verb."""
    parser.add_argument(
        "data", metavar="DATA", help="folder of the image set, video file, camera:0, or a stream's address"
    )
    add_format(parser)
    add_config(parser)
    add_out(parser)
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
    parser.add_argument(
        "--real-time",
        action="store_true",
        help="predict frames as they come, learn from the newest when there is time",
    )
    parser.add_argument("--speed", type=positive_seconds, metavar="X", help="of --real-time (default: 1)")
    parser.add_argument("--attitude", type=Path, metavar="CSV", help="attitude log of a video")
    parser.add_argument("--camera", type=Path, metavar="FILE", help="camera.yaml of a video or camera")
    parser.add_argument(
        "--mavlink", metavar="URL", help="autopilot with the attitude of a camera, in real time; as of `fly`"
    )
    add_autopilot(parser)


def positive_seconds(text: str) -> float:
    """For argparse: a positive number."""
    value = float(text)
    if not 0 < value < float("inf"):
        raise argparse.ArgumentTypeError("must be positive")
    return value


def run(arguments: argparse.Namespace) -> None:
    """Learn until the stream ends, Ctrl-C or SIGTERM; then write the run folder."""
    recording, stream = _source(arguments)
    config = resolve_config(arguments)

    from horizon_dl.errors import InputError
    from horizon_dl.online.real_time import run_in_real_time
    from horizon_dl.online.run import OnlineRun

    if arguments.speed is not None and (stream.live or not arguments.real_time):
        raise InputError("--speed", "has no meaning without --real-time, nor with --mavlink", "leave it out")
    online = OnlineRun(
        stream,
        config,
        arguments.out,
        recording=recording,
        max_frames=arguments.max_frames,
        export_every_s=arguments.export_every,
        restart=arguments.restart,
        overwrite=arguments.overwrite,
        progress=True,
    )
    if online.position:
        online.keeper.say(f"going on at frame {online.position} of {stream.name}")
    more: dict[str, Any] = {}
    with _stopping(online):
        if arguments.real_time or stream.live:
            more = {"real_time": run_in_real_time(online, arguments.speed or 1.0)}
        else:
            online.run()
    online.finish(**more)
    _say(arguments, online, more)


def _source(arguments: argparse.Namespace) -> "tuple[Recording | None, Stream]":
    from horizon_dl.data.capture.camera import is_live
    from horizon_dl.data.capture.stream import recorded_stream, video_stream
    from horizon_dl.data.readers.registry import open_recording
    from horizon_dl.errors import InputError

    if arguments.mavlink is not None:
        return None, _live(arguments)
    if is_live(arguments.data):
        raise InputError(arguments.data, "has no attitude without --mavlink", "name the autopilot's address")
    if arguments.camera_delay or arguments.system != 1 or arguments.signing_key:
        options = "--camera-delay, --system or --signing-key"
        raise InputError(options, "has no meaning without --mavlink", "leave it out")
    path = Path(arguments.data)
    if not path.exists():
        raise InputError(path, "does not exist", "give the folder of a data set, or a video file")
    if path.is_dir():
        recording = open_recording(path, arguments.format)
        return recording, recorded_stream(recording)
    if arguments.attitude is None or arguments.camera is None:
        missing = "--camera" if arguments.attitude else "--attitude"
        raise InputError(path, f"is a video without {missing}", "a video needs both; see --help")
    return None, video_stream(path, arguments.attitude, arguments.camera)


def _live(arguments: argparse.Namespace) -> "Stream":
    from horizon_dl.data.calibration.calibration import read_calibration
    from horizon_dl.data.capture.live import live_stream
    from horizon_dl.errors import InputError
    from horizon_dl.vehicle.mavlink import open_link

    if arguments.attitude is not None:
        raise InputError("--attitude", "has no meaning with --mavlink", "leave one of them out")
    if arguments.camera is None:
        raise InputError(
            "--camera", "is missing", "name the camera.yaml that tells how the camera is mounted"
        )
    check_autopilot(arguments)
    return live_stream(
        arguments.data,
        read_calibration(arguments.camera),
        lambda: open_link(arguments.mavlink, arguments.system, arguments.signing_key),
        arguments.camera_delay,
    )


def _stopping(online: "OnlineRun") -> Any:
    """Ctrl-C and SIGTERM end the run in order; a second Ctrl-C at once."""
    import signal
    from contextlib import contextmanager

    @contextmanager
    def stopping() -> Any:
        def stop(number: int, _: Any) -> None:
            if online.stopped and number == signal.SIGINT:
                raise KeyboardInterrupt
            online.stop()

        before = {number: signal.signal(number, stop) for number in (signal.SIGINT, signal.SIGTERM)}
        try:
            yield
        finally:
            for number, handler in before.items():
                signal.signal(number, handler)

    return stopping()


def _say(arguments: argparse.Namespace, online: "OnlineRun", more: dict[str, Any]) -> None:
    figures, name = online.figures, online.stream.name
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
    print(f"wrote {arguments.out}{rest}; next: horizon-dl evaluate {arguments.out} DATA --out DIR")
