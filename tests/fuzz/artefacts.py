"""What the package writes itself and reads again: checkpoints, run folders, model files, their lists."""

import json
import random
import shutil
from pathlib import Path

import torch

from fuzz.kind import Case, put_back
from fuzz.mutations import damaged
from horizon_dl.download.fetch import _read_sums
from horizon_dl.output.manifest import MANIFEST, check_files, read_manifest
from horizon_dl.runtime.model import ObstacleModel
from horizon_dl.training.checkpoint import Snapshot, read_checkpoint, write_checkpoint
from horizon_dl.training.run_files import FILES
from horizon_dl.training.run_folder import load_run
from horizon_dl.training.tensor_file import _hash_with_blank, _place_of_hash


def checkpoint(folder: Path) -> Case:
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


def manifest(folder: Path) -> Case:
    from horizon_dl.output import output_folder

    with output_folder(folder, "test") as out:
        (out / "a").write_text("1")
    whole = (folder / MANIFEST).read_bytes()

    def case(chance: random.Random) -> None:
        (folder / MANIFEST).write_bytes(damaged(whole, chance))
        read_manifest(folder)
        check_files(folder, ("a",), "make it again")

    return case


def sums(folder: Path) -> Case:
    folder.mkdir(parents=True)
    whole = f"{'0' * 64}  a.zip\n{'1' * 64}  b.tgz\n".encode()

    def case(chance: random.Random) -> None:
        (folder / "SHA256SUMS").write_bytes(damaged(whole, chance))
        _read_sums(folder / "SHA256SUMS")

    return case


def run_folder(folder: Path) -> Case:
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
            put_back(folder, whole, sorted(whole))

    return case


def model_file(folder: Path) -> Case:
    from small_run import model_file

    folder.mkdir(parents=True)
    whole = model_file().read_bytes()
    path = folder / "model.onnx"

    def case(chance: random.Random) -> None:
        path.write_bytes(damaged(whole, chance))
        ObstacleModel.load(path)

    return case


def card(folder: Path) -> Case:
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
