"""The forest's trees as ONNX operators."""

from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from sklearn.tree import DecisionTreeClassifier
from torch import Tensor, nn

from horizon_dl.export.entropy import entropy
from horizon_dl.models.forest import HorizonForest

ML_DOMAIN, ML_OPSET = "ai.onnx.ml", 5
LEAF = -1
SUM, NOTHING, AT_MOST = 1, 0, 0
"""Codes of the operator: leaves of a tree are added, no function follows, branches ask `feature <= split`."""

Attributes = dict[str, Any]


class TreeVotes(nn.Module):
    """Mean probability and mutual information of the trees, at the size of the image.

    Every tree is an operator of its own: one for all would walk through all trees pixel by pixel, and a whole
    forest does not fit the cache.

    Args:
        forest: fitted.
        size: (w, h) of the image.
    """

    def __init__(self, forest: HorizonForest, size: tuple[int, int]) -> None:
        super().__init__()
        self.width, self.height = size
        self.trees: list[DecisionTreeClassifier] = forest.classifier.estimators_
        self.attributes = [tree_attributes(tree) for tree in self.trees]

    def forward(self, features: Tensor) -> tuple[Tensor, Tensor]:
        """Two (h, w) maps of (h * w, 13) features."""
        pairs = zip(self.trees, self.attributes, strict=True)
        votes = torch.stack([_Tree.apply(features, *pair)[:, 0] for pair in pairs])
        mean = votes.mean(dim=0)
        information = (entropy(mean) - entropy(votes).mean(dim=0)).clamp(0.0, 1.0)
        return mean.reshape(self.height, self.width), information.reshape(self.height, self.width)


class _Tree(torch.autograd.Function):
    """(n, 1) votes of (n, 13) features: scikit-learn here, the operator `TreeEnsemble` in the file."""

    @staticmethod
    def forward(_: Any, features: Tensor, tree: DecisionTreeClassifier, __: Attributes) -> Tensor:  # type: ignore[override]
        votes = tree.predict_proba(features.numpy(), check_input=False)[:, 1:]
        return torch.from_numpy(votes.astype(np.float32))

    @staticmethod
    def symbolic(graph: Any, features: Any, _: Any, attributes: Attributes) -> Any:
        found = graph.op(f"{ML_DOMAIN}::TreeEnsemble", features, **attributes)
        return found.setType(features.type().with_sizes([features.type().sizes()[0], 1]))


def tree_attributes(tree: DecisionTreeClassifier) -> Attributes:
    """Attributes of `TreeEnsemble` (ai.onnx.ml 5) for a fitted tree, named as torch's exporter wants them.

    The output of a pixel is the share of "above" among the training pixels of its leaf. Inner nodes and
    leaves are numbered from 0 each. A tree that is nothing but a leaf gets a node with both branches to it.
    """
    fitted = tree.tree_
    shares = fitted.value[:, 0, :]
    p_above = (shares[:, 1] / shares.sum(axis=1)).astype(np.float32)
    leaf = fitted.children_left == LEAF
    number = np.where(leaf, np.cumsum(leaf), np.cumsum(~leaf)) - 1
    inner = np.flatnonzero(~leaf)
    left, right = fitted.children_left[inner], fitted.children_right[inner]
    features, splits = fitted.feature[inner], float32_below(fitted.threshold[inner])
    if not len(inner):
        left, right, features, splits = [0], [0], np.zeros(1, int), np.zeros(1, np.float32)
    return {
        "aggregate_function_i": SUM,
        "post_transform_i": NOTHING,
        "n_targets_i": 1,
        "tree_roots_i": [0],
        "nodes_featureids_i": features.tolist(),
        "nodes_splits_t": torch.from_numpy(splits),
        "nodes_modes_t": torch.full((len(splits),), AT_MOST, dtype=torch.uint8),
        "nodes_truenodeids_i": number[left].tolist(),
        "nodes_trueleafs_i": leaf[left].astype(int).tolist(),
        "nodes_falsenodeids_i": number[right].tolist(),
        "nodes_falseleafs_i": leaf[right].astype(int).tolist(),
        "leaf_targetids_i": [0] * int(leaf.sum()),
        "leaf_weights_t": torch.from_numpy(p_above[leaf]),
    }


def float32_below(values: NDArray[np.float64]) -> NDArray[np.float32]:
    """The largest float32 numbers not over the values: float32 features compare alike with both."""
    near = values.astype(np.float32)
    return np.where(near > values, np.nextafter(near, np.float32(-np.inf)), near)
