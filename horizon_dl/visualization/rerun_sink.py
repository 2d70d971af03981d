"""A sink for the rerun viewer: camera, image, maps, distances as strips, figures over time."""

import math
from pathlib import Path
from typing import Any

import numpy as np

from horizon_dl.data.frame import Frame
from horizon_dl.errors import InputError
from horizon_dl.ranging.sectors import Outcome
from horizon_dl.runtime.prediction import Prediction
from horizon_dl.runtime.ranged import Ranged
from horizon_dl.visualization.colours import BELOW_COLOUR, HEADING_COLOUR, OBSTACLE_COLOUR, colour_map
from horizon_dl.visualization.file_sinks import drawn_ranges
from horizon_dl.visualization.flown import unknown_words

CONNECT = "connect"


class Rerun:
    """Writes an `.rrd` file, or sends to a running viewer.

    Args:
        where: the file's path, or `connect`.
        name: of the recording.

    Raises:
        ModuleNotFoundError: rerun-sdk, of the extra `viz`, is not installed.
        InputError: the file cannot be written.
    """

    def __init__(self, where: str, name: str) -> None:
        import rerun

        self._rerun: Any = rerun
        self._stream: Any = rerun.RecordingStream("horizon_dl", recording_id=None)
        if where == CONNECT:
            self._stream.connect_grpc()
        else:
            path = Path(where)
            if path.suffix != ".rrd" or not path.parent.is_dir():
                raise InputError(
                    f"--rerun {where}", "is no .rrd file in a folder that exists", "or `connect`"
                )
            self._stream.save(str(path))
        self._log("name", rerun.TextDocument(name), static=True)
        # The body's frame: x forward, y right, z down; rerun is told which way is up.
        self._log("body", rerun.ViewCoordinates.FRD, static=True)
        self._pinhole_is_known = False

    def log(self, frame: Frame, prediction: Prediction, ranges: Ranged | None) -> None:
        """See `Sink`."""
        rerun = self._rerun
        if math.isfinite(frame.time_s):
            self._stream.set_time("time", duration=frame.time_s)
        self._pinhole(frame, prediction)
        view = prediction.view
        self._log("camera/image", rerun.Image(view.image).compress(jpeg_quality=80))
        maps = {
            "classification": (prediction.measures.p_above, "sides"),
            "entropy": (prediction.measures.entropy, "uncertainty"),
        }
        if prediction.has_attitude:
            maps["surprisal"] = (prediction.flown_score, "uncertainty")
        for path, (values, table) in maps.items():
            self._log(f"maps/{path}", rerun.Image(colour_map(values, table)).compress(jpeg_quality=80))
        if ranges is not None:
            drawn = rerun.Image(drawn_ranges(prediction, ranges)).compress(jpeg_quality=80)
            self._log("maps/flown", drawn)
        self._log(
            "maps/entropy_over_threshold", rerun.SegmentationImage(prediction.obstacles.astype(np.uint8))
        )
        self._log("figures/entropy_over_threshold", rerun.Scalars(float(prediction.obstacles.mean())))
        if frame.height_m is not None:
            self._log("figures/height_m", rerun.Scalars(frame.height_m))
        if ranges is not None:
            self._distances(ranges, frame.height_m or 0.0)

    def close(self) -> None:
        """See `Sink`."""
        self._stream.flush()
        self._stream.disconnect()

    def _pinhole(self, frame: Frame, prediction: Prediction) -> None:
        if self._pinhole_is_known or frame.camera is None:
            return
        height, width = prediction.measures.entropy.shape
        camera = frame.camera.scaled(width, height)
        pinhole = self._rerun.Pinhole(
            focal_length=(camera.fx, camera.fy),
            principal_point=(camera.cx, camera.cy),
            width=width,
            height=height,
            camera_xyz=self._rerun.ViewCoordinates.RDF,
        )
        self._log("camera", pinhole, static=True)
        self._pinhole_is_known = True

    def _distances(self, ranges: Ranged, height_m: float) -> None:
        """A strip along the floor a bearing, from the body to what is met or is free."""
        self._log("unknown", self._rerun.TextDocument(unknown_words(ranges)))
        found, far_m = ranges.found, ranges.vehicle.far_m
        known = (found.outcome != Outcome.UNKNOWN) & ~np.isnan(found.distance_m)
        metres = np.minimum(np.nan_to_num(found.distance_m[known], posinf=far_m), far_m)
        bearing, met = found.bearing_rad[known], found.outcome[known] == Outcome.OBSTACLE
        floor = np.full_like(metres, height_m)
        ends = np.stack([metres * np.cos(bearing), metres * np.sin(bearing), floor], axis=-1)
        strips = [np.array([[0.0, 0.0, height_m], end]) for end in ends]
        colours = [OBSTACLE_COLOUR if one else BELOW_COLOUR for one in met.tolist()]
        self._log("body/distances", self._rerun.LineStrips3D(strips, colors=colours, radii=0.02))
        near = ranges.nearest()
        if near is not None:
            self._log("figures/nearest_m", self._rerun.Scalars(near[0]))
        way: list[Any] = []
        if ranges.heading is not None:
            turn = ranges.heading.bearing_rad
            way = [[[0, 0, height_m], [far_m * math.cos(turn), far_m * math.sin(turn), height_m]]]
        self._log("body/heading", self._rerun.LineStrips3D(way, colors=[HEADING_COLOUR], radii=0.05))

    def _log(self, path: str, what: Any, static: bool = False) -> None:
        self._stream.log(path, what, static=static)
