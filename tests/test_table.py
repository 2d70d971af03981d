import pytest

from horizon_dl.reporting.table import (
    HEADER,
    METHOD_HEADER,
    format_markdown,
    format_table,
    method_rows,
    metrics_rows,
    metrics_table,
)

METRICS = {
    "schema": 1,
    "seeds": [0, 1],
    "methods": {
        "cnn": {
            "scores": {
                "entropy": {
                    "auc": 0.9312,
                    "auc_sd": 0.0041,
                    "auc_within_depression": 0.91,
                    "auc_within_depression_sd": 0.0,
                    "ap": 0.8,
                    "fpr90": 0.15,
                    "fpr95": 0.25,
                    "best_f1": 0.7,
                },
                "mutual_information": {"auc": 0.8, "auc_within_depression": None},
            },
            "horizon_accuracy": 0.88,
            "train_s": 20.04,
            "predict_ms_per_frame": 4.25,
            "operating_point": {
                "threshold": 0.3,
                "tpr": 0.9,
                "fpr": 0.2,
                "tpr_filtered": 0.89,
                "fpr_filtered": None,
                "rule": "percentile-25",
            },
        },
        "position": {"scores": {"score": {"auc": 0.93, "auc_within_depression": 0.5}}},
    },
}


def test_rows_of_methods_and_scores() -> None:
    rows = metrics_rows(METRICS)
    assert rows[0] == ["CNN", "entropy", "0.931 ± 0.004", "0.910", "0.800", "0.150", "0.250", "0.700"]
    assert rows[1][:4] == ["", "mutual information", "0.800", "-"]
    assert rows[2][:4] == ["position alone", "", "0.930", "0.500"]


def test_both_figures_always_stand_next_to_each_other() -> None:
    assert HEADER.index("AUC within depression") == HEADER.index("AUC") + 1
    assert {len(row) for row in metrics_rows(METRICS)} == {len(HEADER)}


def test_plain_table_is_aligned() -> None:
    lines = metrics_table(METRICS).splitlines()
    end = lines[0].index("AUC within depression") + len("AUC within depression")
    assert [line[end - 5 : end] for line in lines[2:]] == ["0.910", "    -", "0.500"]
    assert set(lines[1]) == {"-"}
    assert len(lines[1]) == max(map(len, lines))


def test_table_by_hand() -> None:
    table = format_table(["method", "AUC"], [["a", "0.5"], ["forest", "0.89"]])
    assert table.splitlines() == ["method   AUC", "------------", "a        0.5", "forest  0.89"]


def test_markdown() -> None:
    assert format_markdown(["a|b", "n"], [["x", "1"]]).splitlines() == [
        "| a\\|b | n |",
        "| --- | ---: |",
        "| x | 1 |",
    ]
    lines = format_markdown(HEADER, metrics_rows(METRICS)).splitlines()
    assert {line.count("|") for line in lines} == {len(HEADER) + 1}


def test_method_rows_leave_out_what_is_unknown() -> None:
    rows = method_rows(METRICS)
    assert len(rows) == 1
    assert dict(zip(METHOD_HEADER, rows[0], strict=True)) == {
        "method": "CNN",
        "horizon accuracy": "0.880",
        "training, s": "20.0",
        "ms a frame": "4.2",
        "threshold rule": "percentile-25",
        "threshold": "0.300",
        "TPR / FPR": "0.900 / 0.200",
        "after the filter": "-",
    }


@pytest.mark.parametrize("missing", ["scores", "operating_point"])
def test_methods_without_a_block_are_no_error(missing: str) -> None:
    method = {name: value for name, value in METRICS["methods"]["cnn"].items() if name != missing}
    metrics = {"methods": {"cnn": method}}
    assert len(metrics_rows(metrics)) == (0 if missing == "scores" else 2)
    assert len(method_rows(metrics)) == 1
