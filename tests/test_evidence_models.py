"""Which model files are refused, at the start and in flight."""

import copy
import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from flat_model import ANY_PLACE
from small_run import model_file, small_export, toy_frames
from test_online_live import predict_until

from horizon_dl.errors import InputError
from horizon_dl.export.export import Exported
from horizon_dl.geometry.camera import Camera
from horizon_dl.output import write_bytes
from horizon_dl.runtime.acceptance import checked_threshold, not_airworthy, smoke_test
from horizon_dl.runtime.hot_reload import HotReloadedModel
from horizon_dl.runtime.model import ObstacleModel

CAMERA = Camera("pinhole", 32, 24, 30.0, 30.0, 15.5, 11.5)


def changed(**card: Any) -> bytes:
    """The small model with other entries in its card."""
    exported = small_export()
    return Exported(exported.graph, {**copy.deepcopy(exported.card), **card}).content()


def evidence(**changes: Any) -> dict[str, Any]:
    return {**small_export().card["evidence"], **changes}


BAD_CARDS = [
    ({"threshold": {"value": -0.1}}, "threshold"),
    ({"threshold": {"value": 0.0}}, "threshold"),
    ({"threshold": {"value": 1.5}}, "threshold"),
    ({"threshold": {"value": True}}, "threshold"),
    ({"threshold": {"value": "0.4"}}, "threshold"),
    ({"threshold": 3}, "cannot be loaded"),
    ({"camera": "none"}, "cannot be loaded"),
    ({"working_size": "80x60"}, "working size"),
    ({"evidence": evidence(frames=0)}, "evidence limits"),
    ({"evidence": [1]}, "evidence limits"),
]
UNFLOWN = [
    ({"evidence": None}, "without limits for its evidence"),
    ({"evidence": evidence(horizon_accuracy=0.6)}, "learned too little"),
]


@pytest.mark.parametrize(("card", "words"), BAD_CARDS)
def test_a_card_that_cannot_be_is_one_line(card: dict[str, Any], words: str, tmp_path: Any) -> None:
    path = tmp_path / "model.onnx"
    path.write_bytes(changed(**card))
    with pytest.raises(InputError, match=words) as error:
        ObstacleModel.load(path)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(("card", "words"), [*BAD_CARDS[::3], *UNFLOWN])
def test_in_flight_it_is_refused_and_the_old_one_flies_on(
    card: dict[str, Any], words: str, tmp_path: Any
) -> None:
    path = tmp_path / "model.onnx"
    path.write_bytes(small_export().content())
    model = HotReloadedModel.load(path)
    before = model.current.sha256
    write_bytes(path, changed(**card))
    predict_until(model, lambda: model.refused == 1)
    assert words in str(model.problem)
    assert model.current.sha256 == before
    assert model.place is not None


def test_what_fits_is_taken() -> None:
    model = ObstacleModel.load(model_file())
    assert not_airworthy(model) is None
    assert smoke_test(model) is None
    assert model.place is not None
    assert model.place.horizon_accuracy > 0.9
    assert checked_threshold({"threshold": {"value": 1}}) == 1.0


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf, -0.1, 0, 1.01, True, "0.4", None, [0.4]])
def test_thresholds_that_cannot_be(value: object) -> None:
    with pytest.raises(ValueError, match="threshold"):
        checked_threshold({"threshold": {"value": value}})


class Says:
    """A model that gives these maps, one after the other."""

    camera = CAMERA
    place = ANY_PLACE

    def __init__(self, *levels: float) -> None:
        self._levels = list(levels)

    def predict(self, image: Any, up_cam: Any = None) -> Any:
        level = self._levels.pop(0) if len(self._levels) > 1 else self._levels[0]
        flat = np.full((24, 32), level, np.float32)
        return SimpleNamespace(p_above=flat, entropy=np.abs(flat) * 0 + 0.5)


@pytest.mark.parametrize(
    ("levels", "problem"),
    [
        ((0.3,), "says the same of every picture"),
        ((0.3, math.nan), "gives no p_above"),
        ((0.3, 1.2), "gives no p_above"),
        ((0.3, -0.2), "gives no p_above"),
        ((0.1, 0.9), None),
    ],
)
def test_maps_that_cannot_be(levels: tuple[float, ...], problem: str | None) -> None:
    found = smoke_test(Says(*levels))
    assert (found is None) if problem is None else str(found).startswith(problem)


def test_a_graph_of_another_camera_than_its_card_is_refused(tmp_path: Any) -> None:
    camera = {**small_export().card["camera"], "width": 64}
    path = tmp_path / "model.onnx"
    path.write_bytes(changed(camera=camera))
    with pytest.raises(InputError, match="cannot be run"):
        ObstacleModel.load(path)
    assert toy_frames()[0].image.shape[1] == 96
