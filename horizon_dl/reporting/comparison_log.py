"""What a comparison shows of its test frames: panels, a film, frames for the page, distances."""

from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from horizon_dl.evaluation.scoring import ScoredFrame
from horizon_dl.evidence.place import usual_levels
from horizon_dl.geometry.rays import camera_rays
from horizon_dl.methods.names import printed_name
from horizon_dl.metrics.range_truth import level_ranges, true_distances
from horizon_dl.metrics.ranging import EVALUATION_BEARINGS, RangingAccumulator
from horizon_dl.output.names import ResultNames
from horizon_dl.ranging.sectors import Outcome
from horizon_dl.reporting.outputs import can_film
from horizon_dl.reporting.run_page import FILM
from horizon_dl.reporting.stills import Still, Stills, auc_of, said_of, still
from horizon_dl.runtime.prediction import Prediction
from horizon_dl.runtime.ranged import Ranged, ranges_of
from horizon_dl.runtime.rules import FlightRules
from horizon_dl.uncertainty.measures import P_ABOVE, Measures, surprisal
from horizon_dl.visualization.colours import Image
from horizon_dl.visualization.file_sinks import panel_row
from horizon_dl.visualization.film import Film
from horizon_dl.visualization.panels import frame_panel, save_panel

MOST_PANELS = 8
Pair = tuple[float, float]


class ComparisonLog:
    """Takes every test frame of the first seed.

    Args:
        folder: of the results.
        frames: how many frames will come; at most 8 of them, evenly spread, become panels.
        names: where panels are written.
        rules: by which frames are ranged and judged; the defaults if left out.

    Attributes:
        stills: for the frame browser.
        aucs: by learner, of each frame with truth: its time and AUC.
        distances: true and stated metres of bearings with a contact in view, by the first learner.
        covered: the same where the obstacle covers the nearest visible ground: at most so far.
        thresholds: by learner, of the last frame.
        film: of the first learner, or None.
    """

    def __init__(
        self, folder: Path, frames: int, names: ResultNames | None = None, rules: FlightRules | None = None
    ) -> None:
        self.stills = Stills()
        self.aucs: dict[str, list[Pair]] = {}
        self.distances: list[Pair] = []
        self.covered: list[Pair] = []
        self.thresholds: dict[str, float] = {}
        self._folder, self._names = folder, names or ResultNames()
        self._rules = rules or FlightRules()
        self._every = max(1, -(-frames // MOST_PANELS))
        self._count = 0
        self.film = Film(folder / FILM) if can_film() and frames > 1 else None

    def __call__(self, scored: ScoredFrame) -> None:
        """Take one test frame."""
        learners = {name: maps for name, maps in scored.maps.items() if P_ABOVE in maps}
        predictions = {name: prediction_of(scored, name, self._rules) for name in learners}
        ranges = {name: ranges_of(scored.frame, one) for name, one in predictions.items()}
        first = next(iter(predictions))
        if self._count % self._every == 0:
            path = self._folder / "panels" / f"{self._names(scored.frame.name)}.jpg"
            save_panel(path, _panel(scored, predictions, ranges))
        if self.film is not None:
            self.film.log(scored.frame, predictions[first], ranges[first])
        self._keep(scored, predictions, ranges, first)
        self._range(scored, first)
        self.thresholds = dict(scored.thresholds)
        self._count += 1

    def close(self) -> None:
        """End the film."""
        if self.film is not None:
            self.film.close()

    def _keep(
        self,
        scored: ScoredFrame,
        predictions: dict[str, Prediction],
        ranges: dict[str, Ranged | None],
        first: str,
    ) -> None:
        view, truth = scored.view, scored.frame.truth
        aucs = {name: auc_of(view, one.flown_score, truth) for name, one in predictions.items()}
        for name, auc in aucs.items():
            if auc is not None:
                self.aucs.setdefault(name, []).append((scored.frame.time_s, auc))

        def drawn() -> Still:
            said = {name: said_of(one, ranges[name], aucs[name]) for name, one in predictions.items()}
            return still(scored.frame, view, said, ranges[first])

        self.stills.add(aucs[first], drawn)

    def _range(self, scored: ScoredFrame, learner: str) -> None:
        """Compare the learner's distances with measured ones, where there are any."""
        frame = scored.frame
        range_m = level_ranges(frame)
        if range_m is None or frame.truth is None:
            return
        p_above, threshold = scored.maps[learner][P_ABOVE], scored.thresholds[learner]
        accumulator = RangingAccumulator(rules=self._rules.ranging)
        found = accumulator.update(
            frame, p_above, range_m, usual=usual_levels(scored.places.get(learner), threshold)
        )
        if found is None:
            return
        truth_m = true_distances(frame, range_m, EVALUATION_BEARINGS)
        known = np.isfinite(truth_m) & np.isfinite(found.distance_m) & (found.outcome == Outcome.OBSTACLE)
        for seen, pairs in ((found.contact_seen, self.distances), (~found.contact_seen, self.covered)):
            pairs += zip(truth_m[known & seen].tolist(), found.distance_m[known & seen].tolist(), strict=True)


def prediction_of(scored: ScoredFrame, method: str, rules: FlightRules | None = None) -> Prediction:
    """What a learner said of a test frame, as any predictor says it; `rules`: the defaults if left out."""
    maps, view = scored.maps[method], scored.view
    p_above: NDArray[np.float32] = maps[P_ABOVE]
    found = Measures(
        p_above,
        maps["entropy"],
        maps["expected_entropy"],
        maps["mutual_information"],
        surprisal(p_above, view.elevation > 0),
    )
    height, width = p_above.shape
    directions = camera_rays(scored.frame.calibrated.scaled(width, height)).directions
    said = Prediction.of(view, found, scored.thresholds[method], directions)
    return replace(said, place=scored.places.get(method), rules=rules or FlightRules())


def comparison_panel(scored: ScoredFrame) -> Image:
    """Image, what is flown, what the paper draws, truth; a row a learner."""
    predictions = {name: prediction_of(scored, name) for name, maps in scored.maps.items() if P_ABOVE in maps}
    ranges = {name: ranges_of(scored.frame, one) for name, one in predictions.items()}
    return _panel(scored, predictions, ranges)


def _panel(
    scored: ScoredFrame, predictions: dict[str, Prediction], ranges: dict[str, Ranged | None]
) -> Image:
    rows = [panel_row(printed_name(name), one, ranges[name]) for name, one in predictions.items()]
    return frame_panel(
        scored.view.image, scored.view.elevation, rows, scored.frame.truth, title=scored.frame.name
    )
