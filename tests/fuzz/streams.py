"""Films and bags: material for libraries that decode in C."""

import random
from collections.abc import Callable
from pathlib import Path

import make_sets
import numpy as np

from fuzz.mutations import damaged
from horizon_dl.data.given import Given
from horizon_dl.data.source import Recording
from horizon_dl.readers.registry import open_recording


def film(folder: Path) -> Callable[[random.Random], None]:
    """A film of ten frames with its log."""
    import av

    folder.mkdir(parents=True)
    path = folder / "film.mp4"
    pixels = np.random.default_rng(0).integers(0, 255, (10, 24, 32, 3), dtype=np.uint8)
    with av.open(str(path), "w") as container:
        stream = container.add_stream("mpeg4", rate=10)
        stream.width, stream.height, stream.pix_fmt = 32, 24, "yuv420p"
        for image in pixels:
            container.mux(stream.encode(av.VideoFrame.from_ndarray(image, format="rgb24")))
        container.mux(stream.encode())
    whole = path.read_bytes()
    (folder / "camera.yaml").write_text(make_sets.CAMERA_YAML)
    given = Given(camera=folder / "camera.yaml", attitude="constant:0,-10")

    def case(chance: random.Random) -> None:
        path.write_bytes(damaged(whole, chance))
        _first_frames(open_recording(path, "film", given))

    return case


def ros_bag(folder: Path) -> Callable[[random.Random], None]:
    """One bag of each kind."""
    from make_bags import Maker, flight

    folder.mkdir(parents=True)
    paths = []
    for kind in ("bag", "db3", "mcap"):
        maker = Maker(ros2=kind != "bag")
        made = maker.write(folder / kind, flight(maker, 3)[0], kind)
        paths.append(made if made.is_file() else next(p for p in made.iterdir() if p.suffix != ".yaml"))
    whole = {path: path.read_bytes() for path in paths}

    def case(chance: random.Random) -> None:
        path = chance.choice(paths)
        try:
            path.write_bytes(damaged(whole[path], chance))
            _first_frames(open_recording(path))
        finally:
            path.write_bytes(whole[path])

    return case


def _first_frames(recording: Recording) -> None:
    for index, _ in enumerate(recording.frames()):
        if index == 2:
            break
