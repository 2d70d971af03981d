"""Configs, options, pictures and archives."""

import io
import os
import random
import shutil
import tarfile
import zipfile
from pathlib import Path

import numpy as np
import yaml
from PIL import Image

from fuzz.kind import Case
from fuzz.mutations import bomb, damaged
from horizon_dl.config import Config, load_config
from horizon_dl.config_file import config_folder
from horizon_dl.data.images import load_rgb, load_truth, load_uint16
from horizon_dl.download.unpack import unpack


def config(folder: Path) -> Case:
    folder.mkdir(parents=True)
    whole = (config_folder() / "default.yaml").read_bytes()
    short = yaml.safe_dump(Config().model_dump(mode="json")).encode()
    path = folder / "config.yaml"

    def case(chance: random.Random) -> None:
        content = damaged(whole if chance.random() < 0.3 else short, chance)
        path.write_bytes(bomb(chance).encode() if chance.random() < 0.03 else content)
        load_config(path)

    return case


def override() -> Case:
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


def image(folder: Path) -> Case:
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


def archive(folder: Path) -> Case:
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
