"""Each figure says which truth it is about."""

from horizon_dl.reporting.heights import height_table
from horizon_dl.runtime.prediction import FLOWN_SCORE


def scores(pooled: float, within: float) -> dict:
    return {"scores": {FLOWN_SCORE: {"auc": pooled, "auc_within_depression": within}}}


def test_the_truths_stand_side_by_side() -> None:
    net = scores(0.9, 0.8) | {"crossing": scores(0.95, 0.85), "low": scores(0.7, 0.6)}
    forest = scores(0.5, 0.4) | {"crossing": None}
    table = height_table({"methods": {"cnn": net, "rf": forest, "position": {"scores": {}}}})
    assert table is not None
    assert list(table.header[2:]) == [
        "stands on the floor",
        "reaches the camera's height",
        "lower than the camera",
    ]
    assert [list(row) for row in table.rows] == [
        ["CNN", FLOWN_SCORE, "0.900 / 0.800", "0.950 / 0.850", "0.700 / 0.600"],
        ["forest", FLOWN_SCORE, "0.500 / 0.400", "- / -", "- / -"],
        ["position alone", "score", "- / -", "- / -", "- / -"],
    ]


def test_without_ranges_there_is_no_such_table() -> None:
    assert height_table({"methods": {"cnn": scores(0.9, 0.8)}}) is None
