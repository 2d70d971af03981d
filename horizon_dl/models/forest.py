"""The paper's learner: a random forest on the features of single pixels."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from sklearn.ensemble import RandomForestClassifier
from sklearn.tree import DecisionTreeClassifier
from sklearn.utils.parallel import Parallel, delayed

from horizon_dl.data.view import View
from horizon_dl.errors import InputError
from horizon_dl.geometry.horizon import IGNORED, horizon_label
from horizon_dl.models.features import FEATURE_NAMES, pixel_features

FEATURES = len(FEATURE_NAMES)


@dataclass(frozen=True)
class HorizonForest:
    """A fitted forest that tells above from below; its trees take the part of the dropout samples.

    Attributes:
        classifier: a plain scikit-learn forest on (n, 13) float32 features, classes 0 below and 1 above.
        n_jobs: threads for prediction, -1 for all cores.
    """

    classifier: RandomForestClassifier
    n_jobs: int = -1

    @classmethod
    def fit(
        cls,
        views: Sequence[View],
        *,
        seed: int,
        band_rad: float = 0.0,
        training_pixels: int = 400_000,
        trees: int = 20,
        min_samples_leaf: int = 10,
        n_jobs: int = -1,
    ) -> "HorizonForest":
        """Fit on pixels drawn evenly from all views; the same seed gives the same forest.

        Args:
            views: read once, one after the other.
            seed: for the drawn pixels and the forest.
            band_rad: half width of the band around the horizon from which no pixel is drawn, rad.
            training_pixels: pixels drawn over all views.
            trees: size of the forest (20 in arXiv:1806.08007).
            min_samples_leaf: training pixels in a leaf (10 in the paper).
            n_jobs: threads, -1 for all cores.

        Raises:
            InputError: if the usable pixels are not from both sides of the horizon.
        """
        per_view = -(-training_pixels // max(len(views), 1))
        drawn = [draw_view_pixels(view, (seed, i), band_rad, per_view) for i, view in enumerate(views)]
        return cls.fit_pixels(
            np.concatenate([np.empty((0, FEATURES), np.float32), *(features for features, _ in drawn)]),
            np.concatenate([np.empty(0, np.uint8), *(labels for _, labels in drawn)]),
            seed=seed,
            trees=trees,
            min_samples_leaf=min_samples_leaf,
            n_jobs=n_jobs,
        )

    @classmethod
    def fit_pixels(
        cls,
        features: NDArray[np.float32],
        labels: NDArray[np.uint8],
        *,
        seed: int,
        trees: int = 20,
        min_samples_leaf: int = 10,
        n_jobs: int = -1,
    ) -> "HorizonForest":
        """Fit on pixels that `draw_view_pixels` drew before.

        Args:
            features: (n, 13) float32.
            labels: (n,) 1 above, 0 below.
            seed: for the forest.
            trees: see `fit`.
            min_samples_leaf: see `fit`.
            n_jobs: see `fit`.

        Raises:
            InputError: if the pixels are not from both sides of the horizon.
        """
        if len(np.unique(labels)) < 2:
            problem = f"the {len(labels)} usable pixels are not from both sides of the horizon"
            raise InputError(
                "training frames", problem, "use frames that show the horizon, or a narrower band"
            )
        classifier = RandomForestClassifier(
            n_estimators=trees, min_samples_leaf=min_samples_leaf, random_state=seed, n_jobs=n_jobs
        )
        return cls(classifier.fit(features, labels), n_jobs)

    def p_above_samples(self, view: View) -> NDArray[np.float32]:
        """Each tree's probability of above: (trees, h, w) float32; their mean is the forest's probability."""
        height, width = view.image.shape[:2]
        features = pixel_features(view.image).reshape(height * width, -1)
        trees = self.classifier.estimators_
        maps = Parallel(n_jobs=self.n_jobs, prefer="threads")(
            delayed(_tree_p_above)(t, features) for t in trees
        )
        return np.stack(maps).reshape(len(trees), height, width)


def draw_view_pixels(
    view: View, seed: int | tuple[int, ...], band_rad: float, count: int
) -> tuple[NDArray[np.float32], NDArray[np.uint8]]:
    """At most `count` labelled pixels of one view, without repetition: (n, 13) features and (n,) labels."""
    label = horizon_label(view.elevation, band_rad).ravel()
    usable = np.flatnonzero(label != IGNORED)
    rng = np.random.default_rng(seed)
    chosen = np.sort(rng.choice(usable, min(count, len(usable)), replace=False))
    features = pixel_features(view.image)
    return features.reshape(-1, features.shape[-1])[chosen], label[chosen]


def _tree_p_above(tree: DecisionTreeClassifier, features: NDArray[np.float32]) -> NDArray[np.float32]:
    """Share of "above" in the leaf of each pixel: (n,)."""
    probabilities: NDArray[np.float64] = tree.predict_proba(features, check_input=False)
    return probabilities[:, 1].astype(np.float32)
