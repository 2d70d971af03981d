"""The onboard loop: a camera, a video or a recorded set in, MAVLink OBSTACLE_DISTANCE out.

  horizon-dl fly MODEL.onnx --source camera:0 --camera camera.yaml --mavlink serial:/dev/ttyAMA0:921600
  horizon-dl fly MODEL.onnx --source DATA --mavlink udpout:127.0.0.1:14550      replays in real time

Attitude comes from the autopilot (ATTITUDE_QUATERNION or ATTITUDE), or as recorded from a data set; height
from DISTANCE_SENSOR, GLOBAL_POSITION_INT or LOCAL_POSITION_NED, or --height. The autopilot has to send
attitudes 10 times a second or more: between two that are over 0.2 s apart every sector is unknown. Without
height nothing is measured in metres, and every sector with an obstacle is unknown. A fresh model file in the
place of MODEL is taken over between two frames. Ctrl-C ends the flight and tells the autopilot so.
"""

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

from horizon_dl.cli.data_options import add_given, given
from horizon_dl.cli.options import (
    add_autopilot,
    add_values,
    add_vehicle_height,
    check_autopilot,
    positive_int,
)
from horizon_dl.cli.viewers import add_viewers
from horizon_dl.ranging.vehicle_height import CAMERA_ALONE

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from horizon_dl.data.frame import Frame
    from horizon_dl.data.source import FrameSource
    from horizon_dl.errors import FrameError
    from horizon_dl.runtime.flight_loop import FlightLoop, FlightSettings
    from horizon_dl.runtime.hot_reload import HotReloadedModel
    from horizon_dl.vehicle.flight_params import FlightParams

AUTOPILOT, RECORDED = "autopilot", "recorded"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Options of the verb."""
    parser.add_argument("model", type=Path, metavar="MODEL", help="what `export` wrote")
    parser.add_argument(
        "--source",
        required=True,
        metavar="S",
        help="folder, film, log, camera:N or a stream's address",
    )
    parser.add_argument(
        "--mavlink",
        required=True,
        metavar="URL",
        help="udpout:HOST:PORT, udpin:HOST:PORT or serial:DEVICE:BAUD; where a recording has an attitude "
        "too, `--attitude recorded` (default) or `--attitude autopilot` says which counts",
    )
    add_given(parser)
    parser.add_argument(
        "--height",
        type=float,
        metavar="M",
        help="fixed height of the camera over the floor (default: measured)",
    )
    parser.add_argument(
        "--rate", type=float, default=20.0, metavar="HZ", help="messages a second (default: 20)"
    )
    parser.add_argument("--min-distance", type=float, default=0.2, metavar="M", help="(default: 0.2)")
    parser.add_argument("--max-distance", type=float, default=10.0, metavar="M", help="(default: 10)")
    parser.add_argument(
        "--filter",
        type=positive_int,
        metavar="N",
        help="frames joined (default: the model's, 3, or 1 with recorded attitude)",
    )
    add_vehicle_height(parser)
    parser.add_argument(
        "--connected-only",
        action="store_const",
        const=CAMERA_ALONE,
        dest="vehicle_height",
        help="the same as --vehicle-height 0,0: only obstacles that reach the horizon",
    )
    add_autopilot(parser)
    parser.add_argument(
        "--threads", type=positive_int, default=1, metavar="N", help="of the model (default: 1)"
    )
    parser.add_argument(
        "--trust", type=Path, metavar="PUBKEY", help="fly only model files signed with its private key (PEM)"
    )
    parser.add_argument("--duration", type=float, metavar="S", help="end after this time")
    parser.add_argument("--speed", type=float, default=1.0, metavar="X", help="of a replay (default: 1)")
    parser.add_argument("--loop", action="store_true", help="replay again and again")
    parser.add_argument("--out", type=Path, metavar="FILE", help="write the flight's figures as JSON")
    parser.add_argument(
        "--record", type=Path, metavar="DIR", help="leave index.html, film.mp4 and flight.json there"
    )
    add_values(parser, "flight")
    parser.add_argument(
        "--dds",
        metavar="[ADDRESS:]DOMAIN",
        help="also publish what ROS 2 nodes read; only for this machine unless an ADDRESS is given",
    )
    add_viewers(parser)


def run(arguments: argparse.Namespace) -> dict[str, Any]:
    """Fly until the source ends, the time is over, Ctrl-C or SIGTERM; then print the figures."""
    import time

    from horizon_dl.cli.flight_views import open_view
    from horizon_dl.evidence.self_assessment import said
    from horizon_dl.output import write_json
    from horizon_dl.runtime.flight_loop import FlightLoop
    from horizon_dl.runtime.perception import Perception
    from horizon_dl.vehicle.mavlink import WARNING, open_link

    source, settings, model = _checked(arguments)
    params = settings.params
    frames = arguments.filter or (1 if settings.recorded_attitude else params.filter_frames)
    perception = Perception.of(model, settings.mount_rpy_rad, frames, params)
    perception.vehicle = arguments.vehicle_height
    link = open_link(arguments.mavlink, arguments.system, arguments.signing_key)
    flight = FlightLoop(perception, link, settings, time.monotonic)
    doubt = said(model.current.card.get("self_assessment"))
    if doubt is not None:
        print(f"the net says of itself: {doubt}", flush=True)
        link.send_text(f"Obstacles: net {doubt.partition(':')[0]}"[:50], WARNING)
    view = open_view(arguments, source, flight, model, perception)
    try:
        _fly(flight, arguments, source)
    finally:
        link.close()
    figures = {**flight.summary(), "model": model.summary()}
    if arguments.record:
        write_json(arguments.record / "flight.json", figures)
    if view is not None:
        view.close()
    if arguments.out:
        write_json(arguments.out, figures)
    _say(figures)
    if arguments.record:
        print(f"look at {arguments.record / 'index.html'}")
    return figures


def _checked(arguments: argparse.Namespace) -> tuple["FrameSource", "FlightSettings", "HotReloadedModel"]:
    """Where frames come from, the flight's settings, and the model: all that can be wrong before take-off."""
    from dataclasses import replace

    from horizon_dl.errors import InputError
    from horizon_dl.runtime.acceptance import not_airworthy
    from horizon_dl.runtime.hot_reload import HotReloadedModel
    from horizon_dl.runtime.predict import check_camera
    from horizon_dl.runtime.signature import read_verifier

    if arguments.out is not None and arguments.out.is_dir():
        raise InputError(f"--out {arguments.out}", "is a folder", "name a file, such as flight.json")
    check_autopilot(arguments)
    source = _source(arguments)
    settings = _settings(arguments, source)
    trusted = None if arguments.trust is None else read_verifier(arguments.trust)
    model = HotReloadedModel.load(arguments.model, arguments.threads, trusted)
    settings = replace(settings, params=flight_params(model.rules.flight, arguments.overrides))
    check_autopilot(arguments, settings.params.stale_s)
    problem = not_airworthy(model.current, model.rules.evidence)
    if problem is not None:
        raise InputError(arguments.model, problem, "train longer and export again")
    if source.camera is not None:
        check_camera(model.current, source.camera, arguments.camera or source.name)
    return source, settings, model


def _fly(flight: "FlightLoop", arguments: argparse.Namespace, source: "FrameSource") -> None:
    """Fly to the end; a service is stopped by SIGTERM, and the autopilot has to be told then, too."""
    import signal

    before = signal.signal(signal.SIGTERM, lambda *_: flight.stop())
    try:
        flight.run(_frames(arguments, source), arguments.duration, source.stop)
    except KeyboardInterrupt:
        pass  # the ordinary end of a flight
    finally:
        signal.signal(signal.SIGTERM, before)


def flight_params(own: "FlightParams", overrides: "Sequence[str]") -> "FlightParams":
    """The model's values with `flight.key=value` on top; InputError for what cannot be."""
    from horizon_dl.data.safe_yaml import parse_yaml
    from horizon_dl.errors import InputError
    from horizon_dl.params import read_params, values_of
    from horizon_dl.vehicle.flight_params import FlightParams

    values: dict[str, object] = dict(values_of(own))
    try:
        for override in overrides:
            key, _, value = override.partition("=")
            values[key.removeprefix("flight.")] = parse_yaml(value)
        return read_params(FlightParams, values, "--flight")
    except ValueError as error:
        raise InputError("fly", str(error), "`horizon-dl fly --help` lists the values") from None


def _source(arguments: argparse.Namespace) -> "FrameSource":
    from dataclasses import replace

    from horizon_dl.data.given import MAVLINK
    from horizon_dl.errors import InputError
    from horizon_dl.sources.open_source import open_source

    beside = given(arguments, needs_attitude=False)
    if arguments.attitude is not None and arguments.attitude.startswith(MAVLINK):
        raise InputError(
            f"--attitude {arguments.attitude}", "has no meaning here", "--mavlink has it already"
        )
    if arguments.attitude in (AUTOPILOT, RECORDED):
        beside = replace(beside, attitude=None)
    return open_source(arguments.source, arguments.format, beside, delay_s=arguments.camera_delay)


def _has_attitude(source: "FrameSource", arguments: argparse.Namespace) -> bool:
    """Whether the frames bring their attitude."""
    from horizon_dl.data.source import Recording

    if isinstance(source, Recording):
        return any(header.up_cam is not None for header in source.headers)
    return arguments.attitude not in (None, AUTOPILOT, RECORDED)


def _settings(arguments: argparse.Namespace, source: "FrameSource") -> "FlightSettings":
    from horizon_dl.errors import InputError
    from horizon_dl.evidence.limits import LIMITS
    from horizon_dl.geometry.polar import LEVEL_UP, level_axes
    from horizon_dl.runtime.flight_loop import FlightSettings
    from horizon_dl.runtime.perception import forward_in_camera
    from horizon_dl.vehicle.obstacle_distance import MessageShape

    known = _has_attitude(source, arguments)
    if arguments.attitude == RECORDED and not known:
        problem = "needs a recording with its attitude"
        raise InputError("--attitude recorded", problem, "take the autopilot's, or name a recording")
    recorded = known and arguments.attitude != AUTOPILOT
    if source.mount_rpy_rad is None and not recorded:
        raise InputError(
            "--camera", "is missing", "name the camera.yaml that tells how the camera is mounted"
        )
    if not 10 <= arguments.rate <= 100:
        raise InputError(f"--rate {arguments.rate:g}", "is not from 10 to 100", "autopilots need 10 a second")
    if arguments.filter is not None and arguments.filter % 2 == 0:
        raise InputError(
            f"--filter {arguments.filter}", "is even, a median needs an odd number", "take 1, 3 or 5"
        )
    if arguments.duration is not None and not 0 < arguments.duration < float("inf"):
        raise InputError(
            f"--duration {arguments.duration:g}", "is no time in seconds", "take 60, or leave it out"
        )
    if not arguments.speed > 0:
        raise InputError(f"--speed {arguments.speed:g}", "is not positive", "take 1 for real time")
    try:
        shape = MessageShape(
            min_cm=round(arguments.min_distance * 100), max_cm=round(arguments.max_distance * 100)
        )
    except (ValueError, OverflowError):
        raise InputError(
            "--min-distance, --max-distance", "make no interval", "take for example 0.2 and 10"
        ) from None
    if arguments.height is not None and not LIMITS.height_m[0] <= arguments.height <= LIMITS.height_m[1]:
        least, most = LIMITS.height_m
        raise InputError(
            f"--height {arguments.height:g}", "is no height in metres", f"take {least:g} to {most:g}"
        )
    mount = source.mount_rpy_rad or (0.0, 0.0, 0.0)
    try:
        level_axes(LEVEL_UP, forward_in_camera(mount))
    except ValueError:
        raise InputError(
            "mount_rpy_deg",
            "has the camera look straight up or down: no bearing is ahead",
            "correct camera.yaml",
        ) from None
    return FlightSettings(
        rate_hz=arguments.rate,
        shape=shape,
        mount_rpy_rad=mount,
        recorded_attitude=recorded,
        height_m=arguments.height,
    )


def _frames(arguments: argparse.Namespace, source: "FrameSource") -> "Iterator[Frame | FrameError]":
    import time

    from horizon_dl.data.source import Recording
    from horizon_dl.sources.replay import replay

    if isinstance(source, Recording):
        return replay(source, time.monotonic, speed=arguments.speed, loop=arguments.loop)
    return source.frames()


def _say(figures: dict[str, Any]) -> None:
    from horizon_dl.cli.flight_views import message_words

    latency, pictures = figures["latency"], figures["pictures"]
    print(f"looked at {pictures['looked_at']} pictures, sent {message_words(figures)}")
    if latency["count"]:
        print(
            f"from image to message: median {latency['median_ms']:.0f} ms, 99 % in {latency['p99_ms']:.0f} ms"
        )
    doubts = {why: n for why, n in figures["evidence"]["frames"].items() if why != "believed"}
    if doubts:
        print("not believed: " + ", ".join(f"{why} ({n})" for why, n in sorted(doubts.items())))
    taken = {why: n for why, n in figures["evidence"]["sectors"].items() if why != "believed"}
    if taken:
        print("sectors taken back: " + ", ".join(f"{why} ({n})" for why, n in sorted(taken.items())))
    if figures["other_autopilots"] and not figures["heartbeats"]:
        print(f"the autopilot heard is system {figures['other_autopilots'][0]}: give it with --system")
    rate_hz = figures["attitudes_hz"]
    if rate_hz is not None and rate_hz < 10 and pictures["without_attitude"]:
        print(f"attitudes came {rate_hz:.1f} times a second; set the autopilot's stream to 10 or more")
    if figures["model"]["taken_over"]:
        print(f"took over {figures['model']['taken_over']} fresh model files in flight")
    if figures["model"]["refused"]:
        print(f"refused {figures['model']['refused']} model files; the last: {figures['model']['problem']}")
