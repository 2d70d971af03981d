"""What a user may set: one range for config and card, and what flies takes the card's."""

import copy
import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from flat_model import ANY_PLACE, FlatModel, TrustingJudge
from small_run import model_file, small_export
from test_evidence_models import changed

from horizon_dl.cli import main
from horizon_dl.config import Config, changed_config, load_config
from horizon_dl.config_file import keys_with_meaning
from horizon_dl.errors import InputError
from horizon_dl.evidence.limits import EvidenceLimits
from horizon_dl.geometry.camera import Camera
from horizon_dl.params import Setting, read_params, settings_of, values_of
from horizon_dl.ranging.contact import ContactDetectorParams
from horizon_dl.ranging.rules import RangingParams
from horizon_dl.ranging.sectors import Outcome
from horizon_dl.runtime.model import ObstacleModel
from horizon_dl.runtime.perception import Perception
from horizon_dl.runtime.rules import FlightRules
from horizon_dl.targets.geodesic_params import GeodesicParams
from horizon_dl.training.predict import flight_rules
from horizon_dl.vehicle.flight_params import FlightParams

SECTIONS: dict[str, type[Any]] = {
    "contact": ContactDetectorParams,
    "ranging": RangingParams,
    "evidence": EvidenceLimits,
    "flight": FlightParams,
    "geodesic": GeodesicParams,
}
EVERY = [(section, one) for section, params in SECTIONS.items() for one in settings_of(params)]
CAMERA = Camera("pinhole", 80, 60, 60.0, 60.0, 39.5, 29.5)


@pytest.mark.parametrize(("section", "one"), EVERY, ids=lambda part: getattr(part, "name", part))
def test_every_value_has_a_meaning_and_one_range_for_config_and_card(section: str, one: Setting) -> None:
    assert one.low <= one.default <= one.high
    assert len({key: meaning for key, _, meaning in keys_with_meaning()}[f"{section}.{one.name}"]) > 15
    for good in (one.low, one.high):
        if one.name != "filter_frames" or good % 2:
            written = load_config(None, [f"{section}.{one.name}={good!r}"])
            assert values_of(getattr(written, section))[one.name] == pytest.approx(good)
    for bad in (one.low - 1, one.high + 1, "many", math.nan, None, [1.0]):
        with pytest.raises(ValueError, match=rf"{section}\.{one.name}") as card:
            read_params(SECTIONS[section], {one.name: bad}, section)
        assert "\n" not in str(card.value)
        text = {"many": "many", None: "null"}.get(bad, bad) if not isinstance(bad, list) else bad
        with pytest.raises(InputError, match=rf"{section}\.{one.name}"):
            load_config(None, [f"{section}.{one.name}={'.nan' if text is math.nan else text}"])


def test_angles_are_degrees_in_files_and_radians_inside() -> None:
    config = load_config(None, ["ranging.unseen_deg=180e-1", "evidence.compared_turn_deg=90"])
    assert config.ranging.unseen_rad == math.radians(18.0)
    assert config.evidence.compared_turn_rad == math.pi / 2
    assert config.model_dump(mode="json")["ranging"]["unseen_deg"] == 18.0


@pytest.mark.parametrize("values", [3, [1], "rise"])
def test_a_section_that_is_none(values: object) -> None:
    with pytest.raises(ValueError, match="contact is no section"):
        FlightRules.of_card({"config": {"contact": values}})


def test_a_file_is_flown_by_the_rules_of_the_config_it_was_exported_with() -> None:
    config = changed_config(Config(), ["contact.rise=0.25", "evidence.proof_s=1", "flight.stale_s=0.5"])
    rules = FlightRules.of_card({"config": config.model_dump(mode="json")})
    assert rules == flight_rules(config)
    assert (rules.ranging.rise.rise, rules.evidence.proof_s, rules.flight.stale_s) == (0.25, 1.0, 0.5)


def test_the_card_of_a_loaded_file_decides(tmp_path: Any) -> None:
    path = tmp_path / "model.onnx"
    settings = copy.deepcopy(small_export().card["config"])
    settings["contact"]["rise"], settings["evidence"]["least_sky"] = 1.5, 0.1
    path.write_bytes(changed(config=settings))
    rules = ObstacleModel.load(path).rules
    assert (rules.ranging.rise.rise, rules.evidence.least_sky) == (1.5, 0.1)


def test_a_file_of_before_the_rules_were_kept_is_flown_by_the_defaults(tmp_path: Any) -> None:
    path = tmp_path / "model.onnx"
    older = {key: value for key, value in small_export().card["config"].items() if key not in SECTIONS}
    path.write_bytes(changed(config=older))
    assert ObstacleModel.load(path).rules == FlightRules()


@pytest.mark.parametrize(
    ("section", "values"),
    [("contact", {"rise": -1}), ("contact", {"slope": 1}), ("flight", {"filter_frames": 2}), ("ranging", 7)],
)
def test_rules_that_cannot_be_are_one_line(section: str, values: object, tmp_path: Any) -> None:
    path = tmp_path / "model.onnx"
    path.write_bytes(changed(config={**small_export().card["config"], section: values}))
    with pytest.raises(InputError, match="cannot be loaded") as error:
        ObstacleModel.load(path)
    assert "\n" not in str(error.value)


class Bump(FlatModel):
    """Sees a faint wall: `p_above` a little over the floor's, 0.4 in log odds, from 25 degrees down on."""

    def predict(self, image: np.ndarray, up_cam: Any = None) -> Any:
        found = super().predict(image, up_cam)
        faint = (found.elevation < 0) & (found.elevation > math.radians(-15))
        found.p_above[faint] = 1 / (1 + math.exp(-(math.log(0.03 / 0.97) + 0.4)))
        return found


@pytest.mark.parametrize(("rise", "outcome"), [(0.7, Outcome.FREE), (0.2, Outcome.OBSTACLE)])
def test_the_flight_ranges_by_the_models_rules(rise: float, outcome: Outcome) -> None:
    model = Bump(CAMERA)
    model.rules = FlightRules(RangingParams(rise=ContactDetectorParams(rise=rise)))
    perception = Perception.of(model, (0.0, 0.0, 0.0))
    perception.judge = TrustingJudge(CAMERA, model.place)
    image = np.zeros((60, 80, 3), np.uint8)
    found = perception.look(0.0, image, np.array([0.0, -1.0, 0.0]), 0.0, 1.0)
    assert (found.outcome[found.nearest_rad > 0.3] == outcome).all()


@pytest.mark.parametrize(("obstacle_p", "outcome"), [(0.3, Outcome.FREE), (0.04, Outcome.OBSTACLE)])
def test_the_flight_ranges_by_how_far_obstacles_stood_out_in_training(
    obstacle_p: float, outcome: Outcome
) -> None:
    """The bump is .4 over a floor of .03 in log odds: much where obstacles are at .04, nothing at .3."""
    model = Bump(CAMERA)
    model.place = replace(ANY_PLACE, floor_p=0.03, obstacle_p=obstacle_p)
    perception = Perception.of(model, (0.0, 0.0, 0.0))
    perception.judge = TrustingJudge(CAMERA, model.place)
    image, up_cam = np.zeros((60, 80, 3), np.uint8), np.array([0.0, -1.0, 0.0])
    flown = perception.look(0.0, image, up_cam, 0.0, 1.0)
    assert (flown.outcome[flown.nearest_rad > 0.3] == outcome).all()


def test_a_fresh_file_brings_its_own_limits() -> None:
    model = FlatModel(CAMERA)
    perception = Perception.of(model, (0.0, 0.0, 0.0))
    model.rules = replace(model.rules, evidence=EvidenceLimits(proof_s=9.0))
    perception.look(0.0, np.zeros((60, 80, 3), np.uint8), np.array([0.0, -1.0, 0.0]), 0.0, 1.0)
    assert perception.judge.limits.proof_s == 9.0


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--train.batch", "4"], "fly takes no config values but those of flight: --train.batch=4"),
        (["--contact.rise", "1"], "fly takes no config values but those of flight"),
        (["--flight.stale_s", "9"], "--flight.stale_s = 9 is not from 0.05 to 2"),
        (["--flight.stale", "1"], "--flight.stale is not known"),
        (["--flight.stale_s", "soon"], "--flight.stale_s is no number"),
        (["--flight.filter_frames", "2"], "filter_frames = 2 is even"),
        (["--flight.stale_s", "0.1", "--camera-delay", "0.2"], "--camera-delay 0.2: is not from 0 to 0.1"),
    ],
)
def test_fly_takes_values_of_its_loop_alone(
    words: list[str], said: str, tmp_path: Any, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "f").mkdir()
    (tmp_path / "camera.yaml").write_text("model: pinhole\n")
    start = ["fly", str(model_file()), "--source", "camera:77", "--mavlink", "udpout:127.0.0.1:9"]
    try:
        code = main([*start, "--attitude", "constant:0,0", *words])
    except SystemExit as end:
        code = int(end.code or 0)
    assert code == 2
    assert said in capsys.readouterr().err


def test_help_lists_the_values_that_a_verb_takes(capsys: pytest.CaptureFixture[str]) -> None:
    for verb, there, not_there in (
        ("fly", "--flight.stale_s 0.3", "--contact.rise"),
        ("export", "--contact.rise", "--train."),
    ):
        with pytest.raises(SystemExit):
            main([verb, "--help"])
        text = capsys.readouterr().out
        assert there in text
        assert not_there not in text.partition("values of the config")[2]
