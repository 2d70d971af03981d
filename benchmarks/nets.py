"""Sets by name, views that stay in memory, and nets that are trained once for all tables."""

import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from unittest.mock import patch

from places import AS_SHIPPED, place_dropout
from safetensors.torch import load_file, save_file

from horizon_dl.config import Config, ModelConfig, load_config
from horizon_dl.data.source import Recording
from horizon_dl.data.view import View
from horizon_dl.errors import FrameError
from horizon_dl.evaluation.compare import split_recording
from horizon_dl.evaluation.scoring import accumulate, read_frame
from horizon_dl.methods.learners import Method, NetMethod
from horizon_dl.metrics.method_accumulator import MethodAccumulator
from horizon_dl.models.fcn import HorizonFCN
from horizon_dl.models.start import start_of, starting_net
from horizon_dl.readers.registry import open_recording
from horizon_dl.simulation.embedded import embedded_set
from horizon_dl.training.context import agreement_of, all_depths
from horizon_dl.training.frame_store import FrameStore
from horizon_dl.training.run_folder import weights
from horizon_dl.training.train import train_net

REAL_SETS = ("arena", "corridor", "hallway", "kitti")
FURTHER_SETS = ("room", "tum_fr1_rpy", "icl_office_kt3")


def set_names() -> list[str]:
    """The embedded set, and those of the real ones that lie below HORIZON_DL_DATA."""
    folder = Path(os.environ.get("HORIZON_DL_DATA", "."))
    return ["embedded", *(name for name in REAL_SETS if (folder / name).is_dir())]


def all_sets() -> list[str]:
    """Those, and the further real ones, which only the table of all methods and the choices take."""
    folder = Path(os.environ.get("HORIZON_DL_DATA", "."))
    return [*set_names(), *(name for name in FURTHER_SETS if (folder / name).is_dir())]


def open_set(name: str) -> Recording:
    """A recording by its name in the tables, or by its folder."""
    if name == "embedded":
        return open_recording(embedded_set())
    return open_recording(
        Path(name) if Path(name).is_absolute() else Path(os.environ["HORIZON_DL_DATA"]) / name
    )


class KeptStore(FrameStore):
    """A store that keeps its views: one recording is learned from many times."""

    def __init__(self, recording: Recording, config: Config, kept: dict[int, View | FrameError]) -> None:
        super().__init__(recording, config)
        self._kept = kept

    def views(self, indices: Iterable[int]) -> Iterator[View]:
        """The usable views among `indices`, each read once."""
        return self.usable((index, self._view(index)) for index in indices)

    def _view(self, index: int) -> View | FrameError:
        if index not in self._kept:
            found = self.read(index)
            self._kept[index] = found if isinstance(found, FrameError) else found[1]
        return self._kept[index]


def store_of(name: str, overrides: Sequence[str] = ()) -> KeptStore:
    """A set's store; the views of the set used last stay in memory."""
    recording, kept = _opened(name)
    return KeptStore(recording, load_config(None, overrides), kept)


@lru_cache(maxsize=1)
def _opened(name: str) -> tuple[Recording, dict[int, View | FrameError]]:
    return open_set(name), {}


def scored(name: str, methods: Mapping[str, Method]) -> dict[str, MethodAccumulator]:
    """Score methods on the test frames of a set, protocol labelled-out."""
    store = store_of(name)
    test = split_recording(store.recording, "labelled-out").test
    readings = (read_frame(methods, frame, view) for frame, view in store.frames(test))
    return accumulate(readings, {}, store.config.labels.band_rad)


def net_method(name: str, net: HorizonFCN) -> NetMethod:
    """A net of `trained_net` as a method, as `compare` has it."""
    store = store_of(name)
    train = split_recording(store.recording, "labelled-out").train
    return NetMethod(net, store.config.geodesic, agreement_of(all_depths(net), store, train))


def trained_net(
    folder: Path, name: str, seed: int, overrides: Sequence[str] = (), place: str = AS_SHIPPED
) -> HorizonFCN:
    """A net trained on a set by the protocol labelled-out, from `folder` if it was trained before.

    Args:
        folder: where the nets are kept.
        name: of the set.
        seed: of the training.
        overrides: on top of the default config.
        place: where the net has its dropout, see `places`.
    """

    def build(config: ModelConfig) -> HorizonFCN:
        return place_dropout(starting_net(config), place)

    store = store_of(name, overrides)
    parts = [name, str(seed), place, start_of(store.config.model), *overrides]
    path = folder / f"{'_'.join(parts).replace('/', '_')}.safetensors"
    if path.exists():
        net = build(store.config.model)
        net.load_state_dict(load_file(path))
        return net.eval()
    with patch("horizon_dl.training.train.starting_net", build):
        net = train_net(store, split_recording(store.recording, "labelled-out").train, seed=seed)
    beside = path.with_suffix(f".{os.getpid()}.part")
    save_file(weights(net), beside)
    beside.replace(path)
    return net
