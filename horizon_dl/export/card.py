"""The card of a model file: what it is, where it comes from, what goes in and what comes out."""

import hashlib
from dataclasses import asdict
from typing import Any

from safetensors.torch import save

from horizon_dl.config import Config
from horizon_dl.data.source import Recording
from horizon_dl.geometry.camera import Camera, working_size
from horizon_dl.methods.names import FOREST, NET
from horizon_dl.models.build import parameter_count
from horizon_dl.models.features import FEATURE_NAMES
from horizon_dl.models.forest import HorizonForest
from horizon_dl.provenance import versions
from horizon_dl.runtime.model import camera_from_card
from horizon_dl.training.evidence import place_of
from horizon_dl.training.run_folder import Run, weights
from horizon_dl.uncertainty.threshold import PaperThreshold

KIND = "horizon-dl obstacle model"
WHAT = (
    "A small fully convolutional net that tells what lies above the horizon from what lies below it, trained "
    "on labels that the attitude gives for free. It stays unsure about what stands on both sides (after "
    "arXiv:1806.08007)."
)
WHAT_FOREST = (
    "The random forest of arXiv:1806.08007 on colour, local binary pattern and Laws texture of single "
    "pixels, as the rival of the net: its trees take the part of the dropout samples. It costs far more time."
)
SAMPLES = (
    "The dropout samples are fixed masks folded into the weights of the last layer, so the file holds no "
    "random operator and repeats itself in every runtime."
)
LIMITS = (
    "Made for one camera in the surroundings it was trained in. Entropy is high on every appearance that it "
    "has seen on both sides or never; the map is no proof of free space."
)
LICENCE = (
    "The program is under the MIT licence; the weights are under the terms of the data they were trained on."
)
PATENTS = "The approach is described in patent application WO 2019/093885."

INPUTS = {
    "image": "uint8 (1, H, W, 3), RGB in [0, 255], upright, at the camera's own size",
    "up_cam": "float32 (3,), the world's up as a unit vector in the camera's optical frame (x right, y down, "
    "z forward); three NaN where the attitude is not known",
}
OUTPUTS = {
    "p_above": "float32 (h, w) in [0, 1]: probability that the appearance belongs above the horizon, mean "
    "over the dropout samples",
    "entropy": "float32 (h, w), bits in [0, 1]: predictive entropy of p_above, the paper's obstacle score",
    "expected_entropy": "float32 (h, w), bits in [0, 1]: entropy less mutual information",
    "mutual_information": "float32 (h, w), bits in [0, 1]: disagreement of the dropout samples, computed on "
    "the net's coarse grid and enlarged, or of the forest's trees",
    "surprisal": "float32 (h, w), bits in [0, 126]: -log2 of the probability of the side of the horizon that "
    "the pixel really is on, the score that is flown; means nothing without up_cam",
    "elevation": "float32 (h, w), rad in [-pi/2, pi/2], positive above the horizon; NaN without up_cam and "
    "where the lens model gives no ray",
    "obstacles": "uint8 (H, W): the paper's map, 1 where the entropy is over the threshold, without pixels "
    "that have no obstacle among their 8 neighbours; nearest-pixel enlargement of the working size",
}
FLOWN = (
    "Along each bearing, from the nearest ground up: free until the log odds of p_above rise over the "
    "floor's level (config: contact, ranging; the rise times how far evidence.obstacle_p lies over "
    "evidence.floor_p in log odds, within [0.5, 1.7], over 0.9), blocked from there on, unknown where "
    "evidence lacks (config: evidence)."
)
LEFT_OUT = {
    "fused": "the path between the sure floor and the horizon is a search, no tensor operator",
    "single_pass_entropy": "a baseline only; the net without dropout would cost a second last layer",
    "free distance": "ranging needs the height, which is no input of the image's graph",
}


def make_card(run: Run, camera: Camera) -> dict[str, Any]:
    """All that is known of a run before anything is measured, ready for JSON.

    `parity` and `measured` come later.
    """
    config, info = run.config, run.info
    net = {
        **config.model.model_dump(mode="json"),
        "start": info.get("start"),
        "parameters": parameter_count(run.net),
        "sampling": SAMPLES,
    }
    return {
        "kind": KIND,
        "learner": NET,
        "what": WHAT,
        "net": net,
        "trained_on": {key: info.get(key) for key in ("data", "format", "frames", "train_s")},
        "trained_camera": camera_is_trained(info, camera),
        "trained_with": info.get("versions"),
        "weights_sha256": weights_hash(run),
        "evidence": evidence_for(run, camera),
        "self_assessment": info.get("self_assessment"),
        "path_agreement": info.get("path_agreement"),
        **_common(config, camera, run.threshold, info.get("threshold_rule")),
    }


def make_forest_card(
    forest: HorizonForest,
    recording: Recording,
    config: Config,
    threshold: float,
    train_s: float,
    path_agreement: float | None,
) -> dict[str, Any]:
    """The same of a forest fitted on a recording, for that recording's camera."""
    trees = forest.classifier.estimators_
    return {
        "kind": KIND,
        "learner": FOREST,
        "what": WHAT_FOREST,
        "forest": {
            **config.forest.model_dump(mode="json"),
            "nodes": sum(tree.tree_.node_count for tree in trees),
            "features": list(FEATURE_NAMES),
        },
        "trained_on": {
            "data": recording.name,
            "format": recording.format,
            "frames": recording.length,
            "train_s": train_s,
        },
        "trained_camera": True,
        "weights_sha256": forest_hash(forest),
        "path_agreement": path_agreement,
        **_common(config, recording.calibrated, threshold, PaperThreshold(config.threshold.percentile).rule),
    }


def _common(config: Config, camera: Camera, threshold: float, rule: str | None) -> dict[str, Any]:
    return {
        "schema": 1,
        "limits": LIMITS,
        "camera": asdict(camera),
        "image_size": [camera.width, camera.height],
        "working_size": list(working_size(camera.width, camera.height, config.image.max_pixels)),
        "inputs": INPUTS,
        "outputs": OUTPUTS,
        "flown": FLOWN,
        "left_out": LEFT_OUT,
        "threshold": {
            "value": threshold,
            "unit": "bits",
            "rule": rule,
            "chosen_on": "the entropies of the training frames; no obstacle label is ever used",
        },
        "false_positive_rate": None,
        "config": config.model_dump(mode="json"),
        "versions": versions(),
        "licence": LICENCE,
        "patents": PATENTS,
    }


def evidence_for(run: Run, camera: Camera) -> dict[str, Any] | None:
    """The limits of the training pictures for another camera's; None for a run of before they were kept."""
    place, max_pixels = place_of(run.info, "run.json"), run.config.image.max_pixels
    if place is None:
        return None
    trained = camera_from_card(run.info) if "camera" in run.info else camera
    same = working_size(camera.width, camera.height, max_pixels) == working_size(
        trained.width, trained.height, max_pixels
    )
    return (place if same else place.at_another_size()).to_card()


def camera_is_trained(info: dict[str, Any], camera: Camera) -> bool:
    """Whether the camera is the one of the training data."""
    return "camera" in info and camera_from_card(info) == camera


def weights_hash(run: Run) -> str:
    """SHA-256 of the weights as a safetensors file: that of the run folder's own."""
    return hashlib.sha256(save(weights(run.net))).hexdigest()


def forest_hash(forest: HorizonForest) -> str:
    """SHA-256 of branches, thresholds and leaves of all trees."""
    digest = hashlib.sha256()
    for tree in (one.tree_ for one in forest.classifier.estimators_):
        for array in (tree.children_left, tree.children_right, tree.feature, tree.threshold, tree.value):
            digest.update(array.tobytes())
    return digest.hexdigest()
