from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image

from horizon_dl.data.frame import Truth
from horizon_dl.visualization.cells import resize_map
from horizon_dl.visualization.colours import (
    HORIZON_COLOUR,
    NO_VALUE_COLOUR,
    OBSTACLE_COLOUR,
    colour_map,
    lookup_table,
)
from horizon_dl.visualization.overlays import (
    contour_coverage,
    draw_horizon,
    draw_obstacles,
    draw_sides,
    shrink_truth,
)
from horizon_dl.visualization.panels import PanelRow, frame_panel, image_bytes, save_panel
from horizon_dl.visualization.text import shorten, text_size

V, U = np.mgrid[:48, :64].astype(float)
LEVEL = (20.25 - V) * 0.01  # rad; the horizon lies at row 20.25
GREY = np.full((48, 64, 3), 100, np.uint8)


def test_uncertainty_colours_are_those_of_matplotlib() -> None:
    from matplotlib import colormaps

    reference = np.array(colormaps["magma"].colors) * 255
    assert np.abs(lookup_table("uncertainty").astype(float) - reference).max() < 4


def test_uncertainty_colours_grow_lighter_all_the_way() -> None:
    luma = lookup_table("uncertainty") @ np.array([0.299, 0.587, 0.114])
    assert (np.diff(luma) > -0.6).all()
    assert luma[-1] > 240 > 5 > luma[0]


def test_sides_are_told_apart_by_hue_and_lightest_in_the_middle() -> None:
    table = lookup_table("sides").astype(int)
    assert table.sum(axis=1).argmax() in range(125, 131)
    assert table[0, 1] > table[0, 2]
    assert table[255, 2] > table[255, 1]


def test_values_beyond_are_clipped_and_nan_is_grey() -> None:
    coloured = colour_map(np.array([[-1.0, 0.0, 1.0, 2.0, np.nan]]), "uncertainty")
    assert (coloured[0, 0] == coloured[0, 1]).all()
    assert (coloured[0, 2] == coloured[0, 3]).all()
    assert tuple(coloured[0, 4]) == NO_VALUE_COLOUR


def test_line_covers_its_width_at_its_place() -> None:
    coverage = contour_coverage(LEVEL, 0.0, 2.0)
    np.testing.assert_allclose(coverage.sum(axis=0), 2.0, atol=1e-6)
    centre = (coverage * V).sum(axis=0) / coverage.sum(axis=0)
    np.testing.assert_allclose(centre, 20.25, atol=0.26)


@given(st.floats(0.1, 3.0), st.floats(-10.0, 10.0))
def test_line_along_a_circle_lies_on_it(slope: float, level: float) -> None:
    """A horizon as a fisheye sees it: no pixel far from the circle, none on it missed."""
    radius = np.hypot(V - 24, U - 32)
    coverage = contour_coverage((radius - 15) * slope, level * slope, 1.5)
    wanted = 15 + level
    assert (coverage[np.abs(radius - wanted) > 2] == 0).all()
    assert (coverage[(np.abs(radius - wanted) < 0.2) & (radius > 4)] > 0.5).all()


def test_horizon_is_drawn_on_a_copy_and_not_where_unknown() -> None:
    elevation = LEVEL.copy()
    elevation[:, :10] = np.nan
    drawn = draw_horizon(GREY, elevation)
    assert (GREY == 100).all()
    assert (drawn[:, :9] == 100).all()
    np.testing.assert_allclose(drawn[20, 30], HORIZON_COLOUR, atol=2)
    assert (drawn[:15] == 100).all()


def test_no_horizon_in_view_leaves_the_image_alone() -> None:
    np.testing.assert_array_equal(draw_horizon(GREY, LEVEL + 1.0, 0.05), GREY)


def test_sides_are_tinted_blue_above_green_below_nothing_in_the_band() -> None:
    drawn = draw_sides(GREY, LEVEL, band_rad=0.05).astype(int)
    assert drawn[5, 5, 2] > 105 > drawn[5, 5, 0]
    assert drawn[40, 5, 1] > 105 > drawn[40, 5, 2]
    assert (drawn[23, 5] == 100).all()


def test_obstacles_stand_out() -> None:
    mask = V > 40
    drawn = draw_obstacles(GREY, mask).astype(int)
    assert (drawn[41:, :, 0] - drawn[41:, :, 2] > 100).all()
    assert np.ptp(drawn[:40], axis=2).max() == 0


def test_sparse_truth_survives_shrinking() -> None:
    truth = np.zeros((400, 600), np.uint8)
    truth[101, 303], truth[250, 17] = Truth.OBSTACLE, Truth.FLOOR
    shrunk = shrink_truth(truth, 60, 40)
    assert shrunk.shape == (40, 60)
    assert (shrunk[10, 30], shrunk[25, 1]) == (Truth.OBSTACLE, Truth.FLOOR)
    assert (shrunk > 0).sum() == 2


def test_truth_enlarges_by_the_nearest() -> None:
    truth = np.array([[1, 2], [3, 0]], np.uint8)
    np.testing.assert_array_equal(shrink_truth(truth, 4, 4), truth.repeat(2, axis=0).repeat(2, axis=1))


def test_maps_keep_their_missing_pixels() -> None:
    values = np.ones((10, 10))
    values[:3] = np.nan
    resized = resize_map(values, 20, 20)
    assert np.isnan(resized[:5]).all()
    assert (resized[8:] == 1).all()


def row(name: str = "CNN") -> PanelRow:
    return PanelRow(
        name, p_above=np.full((24, 32), 0.5), entropy=np.ones((24, 32)), obstacles=V[:24, :32] > 20
    )


def test_panel_has_a_cell_for_everything_and_white_margins() -> None:
    truth = np.full((48, 64), 2, np.uint8)
    panel = frame_panel(GREY, LEVEL, [row()], truth, title="frame", cell_width=128)
    assert panel.shape[1] > 5 * 128
    assert panel.shape[1] < 5 * 128 + 150
    for edge in (panel[:10], panel[:, :10], panel[:, -10:]):
        assert (edge == 255).all()


def test_truth_moves_under_the_image_with_several_methods() -> None:
    truth = np.full((48, 64), 2, np.uint8)
    one = frame_panel(GREY, LEVEL, [row()], truth, cell_width=128)
    two = frame_panel(GREY, LEVEL, [row(), row("forest")], truth, cell_width=128)
    assert two.shape[1] == one.shape[1] - 138
    assert two.shape[0] > one.shape[0] + 96
    lower_left = two[-140:-60, 20:120].astype(int)
    assert (lower_left[..., 0] - lower_left[..., 2] > 60).mean() > 0.9


def test_lit_uncertainty_shows_in_its_cell() -> None:
    dark = frame_panel(GREY, LEVEL, [PanelRow("", entropy=np.zeros((48, 64)))], cell_width=64, legend=False)
    lit = frame_panel(GREY, LEVEL, [PanelRow("", entropy=np.ones((48, 64)))], cell_width=64, legend=False)
    changed = np.argwhere((dark != lit).any(axis=2))
    assert changed[:, 1].min() > 64
    assert len(changed) > 0.9 * 64 * 48


@pytest.mark.parametrize(
    "rows", [[], [PanelRow("nothing")], [row(), PanelRow("half", p_above=np.ones((5, 5)))]]
)
def test_missing_maps_are_no_error(rows: list[PanelRow]) -> None:
    panel = frame_panel(GREY, LEVEL, rows, cell_width=64)
    assert panel.dtype == np.uint8


def test_saved_panel_reads_back(tmp_path: Path) -> None:
    panel = frame_panel(GREY, LEVEL, [row()], cell_width=64)
    save_panel(tmp_path / "deep/panel.png", panel)
    np.testing.assert_array_equal(np.asarray(Image.open(tmp_path / "deep/panel.png")), panel)
    save_panel(tmp_path / "panel.jpg", panel)
    assert Image.open(tmp_path / "panel.jpg").format == "JPEG"
    assert image_bytes(panel).startswith(b"\x89PNG")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["deep", "panel.jpg"]


@given(st.text("abcdefghij ", min_size=1, max_size=60))
def test_shortened_text_fits(text: str) -> None:
    assert text_size(shorten(text, 12, 120), 12)[0] <= 120


def test_obstacle_colour_is_not_a_side() -> None:
    assert np.abs(lookup_table("sides").astype(int) - OBSTACLE_COLOUR).sum(axis=1).min() > 120
