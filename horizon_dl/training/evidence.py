"""What the training pictures were like, for the flight: it goes into `run.json` and the card of the file."""

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from horizon_dl.errors import InputError
from horizon_dl.evidence.limits import LIMITS, EvidenceLimits
from horizon_dl.evidence.place import Place, PlaceCalibration
from horizon_dl.evidence.self_assessment import SelfAssessment
from horizon_dl.models.encoded import EncodedImage
from horizon_dl.models.fcn import HorizonFCN
from horizon_dl.ranging.contact import ContactDetectorParams

EVIDENCE_FRAMES = 100


def place_of(info: Mapping[str, Any], where: str | Path) -> Place | None:
    """The limits in a `run.json`, None for a run of before they were kept; InputError for damaged ones."""
    card = info.get("evidence")
    try:
        return None if card is None else Place.from_card(card)
    except ValueError as error:
        raise InputError(where, str(error), "train again") from None


def training_evidence(
    net: HorizonFCN,
    frames: Iterable[tuple[NDArray[np.uint8], NDArray[np.floating]]],
    limits: EvidenceLimits = LIMITS,
    contact: ContactDetectorParams | None = None,
) -> dict[str, Any]:
    """What a net says of some of its training frames, ready for JSON.

    Args:
        net: trained.
        frames: image, (h, w, 3) uint8 RGB at the working size, and elevation, (h, w) rad.
        limits: of the config.
        contact: of the config; the defaults if left out.

    Returns:
        `evidence`, the limits of `Place` (None if no horizon is in view), and `self_assessment`.
    """
    calibration, assessment = PlaceCalibration(limits, contact or ContactDetectorParams()), SelfAssessment()
    for image, elevation in frames:
        encoded = EncodedImage(net, image)
        calibration.add(image, elevation, encoded.samples().mean(axis=0))
        assessment.update(encoded.of_least_depth(), elevation)
    place = calibration.place()
    card = None if place is None else place.to_card()
    return {"evidence": card, "self_assessment": assessment.compute()}
