"""What is fuzzed: for each kind of input a real one, and what reads it."""

import io
import json
import os
import random
import shutil
import tarfile
import zipfile
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import make_sets
import numpy as np
import torch
import yaml
from PIL import Image

from fuzz.mutations import bomb, damaged
from fuzz.streams import film, ros_bag
from horizon_dl.calibration.calibration import read_calibration
from horizon_dl.config import Config, load_config
from horizon_dl.config_file import config_folder
from horizon_dl.data.images import load_rgb, load_truth, load_uint16
from horizon_dl.download.fetch import _read_sums
from horizon_dl.download.unpack import unpack
from horizon_dl.errors import FrameError
from horizon_dl.logs.attitude_logs.registry import read_attitude
from horizon_dl.output.manifest import MANIFEST, check_files, read_manifest
from horizon_dl.readers.registry import open_recording
from horizon_dl.runtime.model import ObstacleModel
from horizon_dl.training.checkpoint import Snapshot, read_checkpoint, write_checkpoint
from horizon_dl.training.run_files import FILES
from horizon_dl.training.run_folder import load_run
from horizon_dl.training.tensor_file import _hash_with_blank, _place_of_hash

Case = Callable[[random.Random], None]
TEXT = {".csv", ".txt", ".yaml", ".json"}


@dataclass(frozen=True)
class Target:
    """A kind of input.

    Attributes:
        name: for reports.
        share: of all cases.
        prepare: makes the material; what it gives makes and reads one input, and anything but the documented
            errors that that raises is a fault.
    """

    name: str
    share: float
    prepare: Callable[[], Case]


def targets(place: Path) -> list[Target]:
    """All of them, with their material in a folder of their own."""
    makers = {
        "images_csv": make_sets.images_csv,
        "kitti": make_sets.kitti,
        "paparazzi": make_sets.paparazzi,
        "tum": make_sets.tum,
        "euroc": make_sets.euroc,
        "euroc_truth": lambda folder: make_sets.euroc(folder, truth=True),
    }
    readers = [Target(name, 8, partial(_reader, place / name, make)) for name, make in makers.items()]
    return [
        *readers,
        Target("image", 10, partial(_image, place / "image")),
        Target("camera_file", 10, partial(_camera_file, place / "camera")),
        Target("attitude", 5, partial(_attitude, place / "attitude")),
        Target("config", 8, partial(_config, place / "config")),
        Target("override", 8, _override),
        Target("archive", 4, partial(_archive, place / "archive")),
        Target("checkpoint", 6, partial(_checkpoint, place / "checkpoint")),
        Target("manifest", 5, partial(_manifest, place / "manifest")),
        Target("sums", 2, partial(_sums, place / "sums")),
        Target("run_folder", 2, partial(_run_folder, place / "run")),
        Target("model_file", 3, partial(_model_file, place / "model")),
        Target("card", 0.3, partial(_card, place / "card")),
        Target("film", 1, partial(film, place / "film")),
        Target("ros_bag", 1, partial(ros_bag, place / "bags")),
    ]


def _mutated_file(folder: Path, whole: dict[str, bytes], chance: random.Random) -> None:
    """All files as they were but for one or two, which are damaged, lost, or no files at all."""
    for name in chance.sample(sorted(whole), min(len(whole), chance.choice((1, 1, 1, 2)))):
        path = folder / name
        fate = chance.random()
        if fate < 0.01:
            path.unlink()
            os.mkfifo(path)
        elif fate < 0.02:
            path.unlink()
        elif fate < 0.05 and path.suffix == ".yaml":
            path.write_text(bomb(chance))
        else:
            path.write_bytes(damaged(whole[name], chance))


def _restored(folder: Path, whole: dict[str, bytes]) -> None:
    for name, content in whole.items():
        path = folder / name
        if not path.is_file() or path.read_bytes() != content:
            if path.exists() or path.is_symlink():
                path.unlink()
            path.write_bytes(content)


def _files(folder: Path, suffixes: set[str]) -> dict[str, bytes]:
    paths = sorted(path for path in folder.rglob("*") if path.is_file() and path.suffix in suffixes)
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in paths}


def _reader(folder: Path, make: Callable[[Path], Path]) -> Case:
    make(folder)
    whole = _files(folder, {*TEXT, ".png", ".jpg"})
    texts = {name: content for name, content in whole.items() if Path(name).suffix in TEXT}

    def case(chance: random.Random) -> None:
        try:
            _mutated_file(folder, texts if chance.random() < 0.9 else whole, chance)
            recording = open_recording(folder)
            for frame in recording.frames():
                if not isinstance(frame, FrameError):
                    assert frame.up_cam is None or abs(np.linalg.norm(frame.up_cam) - 1) < 1e-6
                break
        finally:
            _restored(folder, whole)

    return case


def _image(folder: Path) -> Case:
    folder.mkdir(parents=True)
    pixels = np.random.default_rng(0).integers(0, 255, (24, 32, 3), dtype=np.uint8)
    whole = {}
    for suffix in ("png", "jpeg", "bmp", "ppm", "tiff", "webp"):
        content = io.BytesIO()
        Image.fromarray(pixels).save(content, suffix)
        whole[f"a.{suffix}"] = content.getvalue()
    for name, array in (("grey.png", pixels[..., 0]), ("depth.png", pixels[..., 0].astype(np.uint16) * 200)):
        content = io.BytesIO()
        Image.fromarray(array).save(content, "png")
        whole[name] = content.getvalue()
    large = io.BytesIO()
    Image.new("1", (9000, 9000)).save(large, "png")

    def case(chance: random.Random) -> None:
        name = chance.choice(sorted(whole))
        path = folder / name
        path.unlink(missing_ok=True)
        if chance.random() < 0.005:
            os.mkfifo(path)
        else:
            path.write_bytes(large.getvalue() if chance.random() < 0.01 else damaged(whole[name], chance))
        chance.choice((load_rgb, load_rgb, lambda p: load_truth(p, (24, 32)), load_uint16))(path)

    return case


def _camera_file(folder: Path) -> Case:
    folder.mkdir(parents=True)
    path = folder / "camera.yaml"
    make_sets.euroc(folder / "euroc")
    matrix = (
        "!!opencv-matrix\n  rows: 3\n  cols: 3\n  dt: d\n  data: [30., 0., 15., 0., 30., 11., 0., 0., 1.]\n"
    )
    whole = [
        make_sets.CAMERA_YAML,
        make_sets.CAMERA_YAML.replace("pinhole", "radtan").replace("[]", "[-0.3, 0.1, 0, 0, 0]", 1)
        + "rotate_image: 90ccw\n",
        (folder / "euroc" / "mav0" / "cam0" / "sensor.yaml").read_text(),
        f"%YAML:1.0\n---\nimage_width: 32\nimage_height: 24\ncamera_matrix: {matrix}"
        "distortion_coefficients: [0.1, 0.0, 0.0, 0.0, 0.0]\n",
        "cam0:\n  camera_model: pinhole\n  distortion_model: radtan\n  distortion_coeffs: [0.1, 0, 0, 0]\n"
        "  intrinsics: [30, 30, 15, 11]\n  resolution: [32, 24]\n",
        "image_width: 32\nimage_height: 24\ndistortion_model: plumb_bob\ncamera_name: a\n"
        "camera_matrix: {rows: 3, cols: 3, data: [30, 0, 15, 0, 30, 11, 0, 0, 1]}\n"
        "distortion_coefficients: {rows: 1, cols: 5, data: [0, 0, 0, 0, 0]}\n",
    ]

    def case(chance: random.Random) -> None:
        text = bomb(chance) if chance.random() < 0.05 else chance.choice(whole)
        if chance.random() < 0.05:
            text += "\n" + bomb(chance)
        path.write_bytes(damaged(text.encode(), chance))
        read_calibration(path)

    return case


def _attitude(folder: Path) -> Case:
    folder.mkdir(parents=True)
    path = folder / "log.csv"
    rows = "".join(f"{t / 10},0.1,-0.2,{t / 7},1.5\n" for t in range(20))
    whole = f"time_s,roll_rad,pitch_rad,yaw_rad,height_m\n{rows}".encode()

    def case(chance: random.Random) -> None:
        if chance.random() < 0.3:
            read_attitude(damaged(b"constant:0.5,-12.5", chance).decode(errors="replace"))
            return
        path.write_bytes(damaged(whole, chance))
        log = read_attitude(str(path))
        log.header("a", chance.choice((0.5, 1e300, -1.0, float("nan"))), (0.0, 0.0, 0.0))

    return case


def _config(folder: Path) -> Case:
    folder.mkdir(parents=True)
    whole = (config_folder() / "default.yaml").read_bytes()
    short = yaml.safe_dump(Config().model_dump(mode="json")).encode()
    path = folder / "config.yaml"

    def case(chance: random.Random) -> None:
        content = damaged(whole if chance.random() < 0.3 else short, chance)
        path.write_bytes(bomb(chance).encode() if chance.random() < 0.03 else content)
        load_config(path)

    return case


def _override() -> Case:
    whole = (
        "train.rounds=[300, 400]",
        "model.kind=fcn",
        "seed=3",
        "train.learning_rate=0.01",
        "online.batch=4",
    )

    def case(chance: random.Random) -> None:
        given = [damaged(one.encode(), chance).decode(errors="replace") for one in chance.sample(whole, 2)]
        load_config(None, given)

    return case


def _archive(folder: Path) -> Case:
    folder.mkdir(parents=True)
    (folder / "a").mkdir()
    (folder / "a" / "frames.csv").write_text("image,time_s\n" * 20)
    with zipfile.ZipFile(folder / "set.zip", "w", zipfile.ZIP_DEFLATED) as zipped:
        zipped.write(folder / "a" / "frames.csv", "a/frames.csv")
    with tarfile.open(folder / "set.tgz", "w:gz") as tar:
        tar.add(folder / "a", "a")
    whole = {name: (folder / name).read_bytes() for name in ("set.zip", "set.tgz")}

    def case(chance: random.Random) -> None:
        name = chance.choice(sorted(whole))
        content = whole[name]
        if name == "set.zip" and chance.random() < 0.1:  # marked as encrypted
            content = content.replace(b"PK\x03\x04\x14\x00\x00", b"PK\x03\x04\x14\x00\x01")
            content = content.replace(b"PK\x01\x02\x14\x03\x14\x00\x00", b"PK\x01\x02\x14\x03\x14\x00\x01")
        (folder / name).write_bytes(damaged(content, chance) if chance.random() < 0.9 else content)
        try:
            unpack(folder / name, folder / "out")
        finally:
            shutil.rmtree(folder / "out", ignore_errors=True)

    return case


def _checkpoint(folder: Path) -> Case:
    folder.mkdir(parents=True)
    path = folder / "checkpoint.safetensors"
    write_checkpoint(
        path, Snapshot({"a": torch.rand(5, 7), "b": torch.arange(9)}, {"place": {"position": 3}})
    )
    whole = path.read_bytes()

    def case(chance: random.Random) -> None:
        path.write_bytes(damaged(whole, chance))
        found = _place_of_hash(path)
        if found is not None and chance.random() < 0.7:  # a checksum that fits: what comes behind it is tried
            with path.open("r+b") as file:
                file.seek(found)
                file.write(_hash_with_blank(path, found).encode())
        read_checkpoint(path)

    return case


def _manifest(folder: Path) -> Case:
    from horizon_dl.output import output_folder

    with output_folder(folder, "test") as out:
        (out / "a").write_text("1")
    whole = (folder / MANIFEST).read_bytes()

    def case(chance: random.Random) -> None:
        (folder / MANIFEST).write_bytes(damaged(whole, chance))
        read_manifest(folder)
        check_files(folder, ("a",), "make it again")

    return case


def _sums(folder: Path) -> Case:
    folder.mkdir(parents=True)
    whole = f"{'0' * 64}  a.zip\n{'1' * 64}  b.tgz\n".encode()

    def case(chance: random.Random) -> None:
        (folder / "SHA256SUMS").write_bytes(damaged(whole, chance))
        _read_sums(folder / "SHA256SUMS")

    return case


def _run_folder(folder: Path) -> Case:
    from small_run import small_run_folder

    shutil.copytree(small_run_folder(), folder)
    whole = {name: (folder / name).read_bytes() for name in (*FILES, MANIFEST)}

    def case(chance: random.Random) -> None:
        try:
            if chance.random() < 0.7:
                (
                    folder / MANIFEST
                ).unlink()  # as an older version left it: nothing but the parsers stands guard
            name = chance.choice(FILES)
            (folder / name).write_bytes(damaged(whole[name], chance))
            load_run(folder)
        finally:
            _restored(folder, whole)

    return case


def _model_file(folder: Path) -> Case:
    from small_run import model_file

    folder.mkdir(parents=True)
    whole = model_file().read_bytes()
    path = folder / "model.onnx"

    def case(chance: random.Random) -> None:
        path.write_bytes(damaged(whole, chance))
        ObstacleModel.load(path)

    return case


def _card(folder: Path) -> Case:
    """A whole model file whose card is damaged, with a checksum that fits."""
    from small_run import small_export

    from horizon_dl.export.export import Exported
    from horizon_dl.methods.onnx_file import load_file_run

    folder.mkdir(parents=True)
    export = small_export()
    path = folder / "model.onnx"
    keys = ("camera", "threshold", "working_size", "config", "trained_on", "learner", "image_size")

    def case(chance: random.Random) -> None:
        card = json.loads(json.dumps(export.card))
        key = chance.choice(keys)
        try:
            card[key] = json.loads(damaged(json.dumps(card[key]).encode(), chance))
            content = Exported(export.graph, card).content()
        except (ValueError, TypeError, RecursionError):
            card[key] = chance.choice((None, [], {}, 7, "x", -1, [1, 2, 3]))
            content = Exported(export.graph, card).content()
        path.write_bytes(content)
        load_file_run(path)

    return case
