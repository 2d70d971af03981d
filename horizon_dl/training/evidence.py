"""What the training pictures were like, for the flight: it goes into `run.json` and the card of the file."""

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from horizon_dl.config import Config
from horizon_dl.data.view import View
from horizon_dl.errors import InputError
from horizon_dl.evidence.place import Place, PlaceCalibration
from horizon_dl.evidence.self_assessment import SelfAssessment
from horizon_dl.models.encoded import EncodedImage
from horizon_dl.models.fcn import HorizonFCN
from horizon_dl.models.start import simulated_net
from horizon_dl.uncertainty.measures import binary_entropy, p_of_entropy
from horizon_dl.uncertainty.taught_threshold import TaughtThreshold

EVIDENCE_FRAMES = 100


def place_of(info: Mapping[str, Any], where: str | Path) -> Place | None:
    """The limits in a `run.json`, None for a run of before they were kept; InputError for damaged ones."""
    card = info.get("evidence")
    try:
        return None if card is None else Place.from_card(card)
    except ValueError as error:
        raise InputError(where, str(error), "train again") from None


def training_evidence(net: HorizonFCN, views: Iterable[View], config: Config) -> dict[str, Any]:
    """What a net says of some of its training frames, ready for JSON.

    Args:
        net: trained.
        views: of the frames, at the working size.
        config: its limits, and how the floor's level is taken.

    Returns:
        `evidence`, the limits of `Place` (None if no horizon is in view); by the word of the net of the
        simulated worlds `self_assessment` and `simulated_threshold` (bits, see `TaughtThreshold`); and the
        `deep_share` of the prediction.
    """
    calibration, assessment = PlaceCalibration(config.evidence, config.ranging_params), SelfAssessment()
    simulated, threshold = simulated_net(), TaughtThreshold()
    for view in views:
        p_above = EncodedImage(net, view.image).p_above()
        p_obstacle = EncodedImage(simulated, view.image).of_all_depths()
        below = view.elevation < -config.labels.band_rad
        calibration.add(view.image, view.elevation, p_above)
        assessment.update(p_above, p_obstacle, view.elevation)
        threshold.update(binary_entropy(p_above[below]), p_obstacle[below])
    bits = threshold.compute()
    place = calibration.place(obstacle_p=None if bits is None else p_of_entropy(bits))
    return {
        "evidence": None if place is None else place.to_card(),
        "self_assessment": assessment.compute(),
        "simulated_threshold": bits,
        "deep_share": net.deep_share,
    }
