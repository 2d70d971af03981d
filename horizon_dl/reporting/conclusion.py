"""What a comparison or an evaluation comes to, in a sentence or two; whatever the figures say."""

from collections.abc import Mapping
from typing import Any

from horizon_dl.evidence.self_assessment import said
from horizon_dl.methods.names import LEARNERS, TRAINING_FREE, printed_name
from horizon_dl.runtime.prediction import FLOWN_SCORE, PAPER_SCORE

ALIKE = 0.005
"""Differences in AUC under this are said to be none."""

THE_PAPERS = "the paper's"

Both = tuple[float, float]
_IN_WORDS = {
    "rf": "the forest",
    "position": "position alone",
    "diffusion": "the guided diffusion of the horizon label",
    "geodesic": "the geodesic diffusion of the horizon label",
}


def headline_score(method: str) -> str:
    """The score by which a method is named in one figure."""
    return "score" if method in TRAINING_FREE else FLOWN_SCORE


def both_aucs(metrics: Mapping[str, Any], method: str, score: str | None = None) -> Both | None:
    """AUC pooled and within depression bands of a method; None where there is none."""
    block = metrics["methods"].get(method, {}).get("scores", {}).get(score or headline_score(method))
    if not block or block.get("auc") is None or block.get("auc_within_depression") is None:
        return None
    return block["auc"], block["auc_within_depression"]


def learner_of(metrics: Mapping[str, Any]) -> str | None:
    """The method that the report is about: the net where there is one."""
    return next((name for name in LEARNERS if name in metrics["methods"]), None)


def strongest_baseline(metrics: Mapping[str, Any]) -> str | None:
    """The method without learning with the highest AUC within the bands."""
    found = {name: both for name in TRAINING_FREE if (both := both_aucs(metrics, name)) is not None}
    return max(found, key=lambda name: found[name][1], default=None)


def conclusion(metrics: Mapping[str, Any]) -> str:
    """The report's first paragraphs."""
    learner = learner_of(metrics)
    own = None if learner is None else both_aucs(metrics, learner)
    if learner is None or own is None:
        return "Without truth below the horizon there are no figures, only pictures."
    name, rivals = printed_name(learner), []
    for rival in ("rf", "position"):
        theirs = both_aucs(metrics, rival)
        if rival != learner and theirs is not None:
            rivals.append(_against(own[1] - theirs[1], _IN_WORDS[rival]))
    words = f"The {name} {' and '.join(rivals)} within depression bands." if rivals else ""
    doubt = said(metrics["methods"][learner].get("self_assessment"))
    sentences = [
        words,
        _of_baseline(own, metrics),
        _of_position(own, metrics, name),
        "" if doubt is None else f"Without any label the net says of itself: {doubt}.",
    ]
    figures = (
        f"{name}, {FLOWN_SCORE}, the score that is flown: AUC {own[0]:.3f} pooled, {own[1]:.3f} within bands"
        f"{_of_score(metrics, learner, PAPER_SCORE, THE_PAPERS)}{_best_score(metrics, learner, own)}."
    )
    return " ".join(one for one in sentences if one) + f"\n\n{figures} {_trained_on(metrics)}".rstrip()


def _against(by: float, rival: str) -> str:
    if abs(by) < ALIKE:
        return f"is as good as {rival}"
    return f"beats {rival} by {by:.2f}" if by > 0 else f"loses to {rival} by {-by:.2f}"


def _of_baseline(own: Both, metrics: Mapping[str, Any]) -> str:
    best = strongest_baseline(metrics)
    theirs = None if best is None else both_aucs(metrics, best)
    if best is None or theirs is None:
        return ""
    name, by = _IN_WORDS[best], own[1] - theirs[1]
    if by < -ALIKE:
        return f"On this set it is not the best: {name} is ahead by {-by:.2f}, without any training."
    if by < ALIKE:
        return f"On this set {name} is as good, without any training."
    return f"The strongest method that learns nothing is {name}, {by:.2f} behind."


def _of_position(own: Both, metrics: Mapping[str, Any], name: str) -> str:
    position = both_aucs(metrics, "position")
    if position is None or own[0] - position[0] >= ALIKE:
        return ""
    return (
        f"Pooled over the whole picture the {name} does not beat position alone ({own[0]:.3f} against "
        f"{position[0]:.3f}): here where a pixel lies tells more than how it looks."
    )


def _best_score(metrics: Mapping[str, Any], learner: str, own: Both) -> str:
    scores = metrics["methods"][learner]["scores"]
    found = {name: both for name in scores if (both := both_aucs(metrics, learner, name)) is not None}
    best = max(found, key=lambda name: found[name][1])
    if best in (FLOWN_SCORE, PAPER_SCORE) or found[best][1] - own[1] < ALIKE:
        return ""
    return _of_score(metrics, learner, best, "which is not flown")


def _of_score(metrics: Mapping[str, Any], learner: str, score: str, what: str) -> str:
    found = both_aucs(metrics, learner, score)
    return "" if found is None else f"; {score.replace('_', ' ')}, {what}: {found[0]:.3f} and {found[1]:.3f}"


def _trained_on(metrics: Mapping[str, Any]) -> str:
    if metrics["protocol"] == "evaluate":
        trained_on = metrics.get("trained_on")
        if trained_on == metrics["data"]:
            return "It was trained on these frames, or on others of this very flight: expect less elsewhere."
        return f"It was trained on {trained_on}." if trained_on else ""
    if metrics["protocol"] == "prequential":
        return "Every frame was predicted before it was learned from."
    return "The frames scored here were not trained on."
