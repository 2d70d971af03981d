from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from horizon_dl.reporting.curves import (
    MOST_POINTS,
    OperatingPoint,
    RocLine,
    figure_bytes,
    reliability,
    reliability_figure,
    roc_figure,
    save_figure,
    thin_curve,
)

X = np.linspace(0, 1, 5000)
LINE = RocLine(
    "CNN", X, X**0.2, auc=0.8333, points=[OperatingPoint(0.2, 0.7), OperatingPoint(0.1, 0.6, filtered=True)]
)
POSITION = RocLine("position alone", X, X**0.5, auc=0.667, baseline=True)


def test_legend_holds_names_and_areas() -> None:
    axes = roc_figure([LINE, POSITION], "arena").axes[0]
    assert [text.get_text() for text in axes.get_legend().get_texts()] == [
        "CNN  0.833",
        "position alone  0.667",
    ]
    assert axes.get_title() == "arena"


def test_baselines_are_dashed_and_points_open_after_the_filter() -> None:
    lines = {line.get_label(): line for line in roc_figure([LINE, POSITION]).axes[0].lines}
    assert lines["CNN  0.833"].get_linestyle() == "-"
    assert lines["position alone  0.667"].get_linestyle() == "--"
    markers = [line for line in lines.values() if line.get_marker() == "o"]
    assert [(float(m.get_xdata()[0]), m.get_markerfacecolor()) for m in markers][1] == (0.1, "white")
    assert markers[0].get_markerfacecolor() == lines["CNN  0.833"].get_color()


def test_thinned_curve_keeps_its_ends_and_its_area() -> None:
    x, y = thin_curve(X, X**0.2)
    assert len(x) <= MOST_POINTS + 2
    assert (x[0], y[0], x[-1], y[-1]) == (0, 0, 1, 1)
    assert np.trapezoid(y, x) == pytest.approx(np.trapezoid(X**0.2, X), abs=1e-3)


def test_many_methods_get_a_line_each() -> None:
    lines = [RocLine(f"m{n}", X, X, auc=None, baseline=n % 2 == 0) for n in range(20)]
    assert len(roc_figure(lines).axes[0].get_legend().get_texts()) == 20


def test_reliability_by_hand() -> None:
    p = np.array([0.05, 0.05, 0.95, 0.95, 1.0])
    predicted, observed, counts = reliability(p, np.array([False, True, True, True, False]), bins=2)
    np.testing.assert_allclose(predicted, [0.05, 2.9 / 3])
    np.testing.assert_allclose(observed, [0.5, 2 / 3])
    assert counts.tolist() == [2, 3]


def test_reliability_agrees_with_scikit_learn() -> None:
    from sklearn.calibration import calibration_curve

    chance = np.random.default_rng(0)
    p = chance.random(5000)
    above = chance.random(5000) < p**2
    predicted, observed, _ = reliability(p, above, bins=8)
    reference_observed, reference_predicted = calibration_curve(above, p, n_bins=8)
    np.testing.assert_allclose(predicted, reference_predicted)
    np.testing.assert_allclose(observed, reference_observed)


def test_empty_bins_are_nan_and_drawn() -> None:
    predicted, observed, _ = reliability(np.array([0.1]), np.array([True]))
    assert np.isnan(predicted).sum() == np.isnan(observed).sum() == 9
    assert figure_bytes(reliability_figure({"CNN": (predicted, observed)}), "png").startswith(b"\x89PNG")


def test_files_by_ending_and_the_same_twice(tmp_path: Path) -> None:
    save_figure(tmp_path / "roc.svg", roc_figure([LINE]))
    save_figure(tmp_path / "again.svg", roc_figure([LINE]))
    save_figure(tmp_path / "roc.png", roc_figure([LINE]))
    assert (tmp_path / "roc.svg").read_bytes() == (tmp_path / "again.svg").read_bytes()
    assert b"<svg" in (tmp_path / "roc.svg").read_bytes()
    assert Image.open(tmp_path / "roc.png").width > 500
