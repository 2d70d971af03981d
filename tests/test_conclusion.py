"""The sentence at the head of a report says what the figures say, also where they are bad."""

from horizon_dl.reporting.conclusion import conclusion


def metrics(protocol="labelled-out", trained_on=None, **aucs):
    methods = {}
    for name, (pooled, within) in aucs.items():
        score = "surprisal" if name in ("cnn", "rf") else "score"
        methods[name] = {"scores": {score: {"auc": pooled, "auc_within_depression": within}}}
    return {"protocol": protocol, "data": "arena", "methods": methods, "trained_on": trained_on}


def test_better_than_all() -> None:
    words = conclusion(metrics(cnn=(0.99, 0.97), rf=(0.9, 0.71), position=(0.94, 0.58), geodesic=(0.9, 0.8)))
    assert "The CNN beats the forest by 0.26 and beats position alone by 0.39 within depression" in words
    assert "geodesic diffusion of the horizon label, 0.17 behind" in words
    assert "AUC 0.990 pooled, 0.970 within bands" in words
    assert "does not beat" not in words


def test_no_better_than_position_is_said() -> None:
    words = conclusion(metrics(cnn=(0.80, 0.60), rf=(0.7, 0.65), position=(0.82, 0.5)))
    assert "loses to the forest by 0.05" in words
    assert "does not beat position alone (0.800 against 0.820)" in words


def test_a_baseline_that_is_ahead_is_named() -> None:
    ahead = conclusion(metrics(cnn=(0.9, 0.6), geodesic=(0.9, 0.8), position=(0.8, 0.5)))
    assert "not the best: the geodesic diffusion of the horizon label is ahead by 0.20" in ahead
    alike = conclusion(metrics(cnn=(0.9, 0.8), geodesic=(0.9, 0.801)))
    assert "is as good, without any training" in alike


def test_where_it_was_trained_is_said() -> None:
    both = {"cnn": (0.9, 0.8), "position": (0.8, 0.5)}
    assert "was trained on these frames" in conclusion(metrics("evaluate", "arena", **both))
    assert "was trained on kitti" in conclusion(metrics("evaluate", "kitti", **both))
    assert "predicted before it was learned from" in conclusion(metrics("prequential", **both))


def test_without_truth_there_are_no_figures() -> None:
    assert "only pictures" in conclusion(metrics(cnn=(None, None)))


def test_what_is_flown_is_named_with_the_papers_score_beside_it() -> None:
    """The best figure is not the product's own where it is not flown."""
    found = metrics(cnn=(0.9, 0.8), position=(0.8, 0.5))
    scores = found["methods"]["cnn"]["scores"]
    scores["entropy"] = {"auc": 0.88, "auc_within_depression": 0.79}
    scores["fused"] = {"auc": 0.95, "auc_within_depression": 0.9}
    words = conclusion(found)
    assert "CNN, surprisal, the score that is flown: AUC 0.900 pooled, 0.800 within bands" in words
    assert "entropy, the paper's: 0.880 and 0.790" in words
    assert "fused, which is not flown: 0.950 and 0.900" in words
    assert "best score" not in words
