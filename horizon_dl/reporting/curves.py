"""Curves: ROC with operating points, training progress and reliability."""

import io
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from horizon_dl.metrics.calibration_error import Reliability
from horizon_dl.output import write_bytes

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Floats = NDArray[np.floating]

# Okabe and Ito's colours without the yellow, told apart by colour-blind readers, too.
LINE_COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9", "#E69F00", "#333333")
MOST_POINTS = 600
_STYLE: dict[str, object] = {
    "font.family": "DejaVu Sans",
    "font.size": 9,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.edgecolor": "#888888",
    "axes.labelcolor": "#333333",
    "xtick.color": "#555555",
    "ytick.color": "#555555",
    "svg.hashsalt": "horizon-dl",  # the same figure gives the same file
}


@dataclass(frozen=True)
class OperatingPoint:
    """A threshold's true- and false-positive rate, shown as a marker on the ROC.

    `filtered` marks the rates after the neighbour filter (an open marker).
    """

    fpr: float
    tpr: float
    filtered: bool = False


@dataclass(frozen=True)
class RocLine:
    """One method's ROC.

    Attributes:
        name: as in the legend.
        fpr: (n,) rising from 0 to 1.
        tpr: (n,) rising from 0 to 1.
        auc: shown in the legend; None hides it.
        baseline: drawn dashed and grey, such as position alone.
        points: operating points.
    """

    name: str
    fpr: Floats
    tpr: Floats
    auc: float | None = None
    baseline: bool = False
    points: Sequence[OperatingPoint] = ()


def thin_curve(x: Floats, y: Floats, most: int = MOST_POINTS) -> tuple[Floats, Floats]:
    """At most about `most` points of a curve, evenly spaced along its length, both ends kept."""
    if len(x) <= most:
        return x, y
    length = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(x), np.diff(y)))])
    wanted = np.linspace(0.0, length[-1], most)
    keep = np.unique(np.concatenate([[0, len(x) - 1], np.searchsorted(length, wanted).clip(0, len(x) - 1)]))
    return x[keep], y[keep]


def new_axes(width_in: float, height_in: float) -> "tuple[Figure, Axes]":
    """A figure outside pyplot's registry, so that long runs leak none."""
    from matplotlib import rc_context
    from matplotlib.figure import Figure

    with rc_context(_STYLE):
        figure = Figure(figsize=(width_in, height_in), layout="constrained")
        axes = figure.add_subplot()
        axes.grid(True, color="#e8e8e8", linewidth=0.8)
        axes.set_axisbelow(True)
    return figure, axes


def roc_figure(lines: Sequence[RocLine], title: str = "") -> "Figure":
    """ROC curves of several methods; filled markers: the threshold's rates, open: after the filter.

    Example:
        >>> line = RocLine("CNN", np.array([0, 0.1, 1]), np.array([0, 0.8, 1]), auc=0.85)
        >>> figure = roc_figure([line])
    """
    figure, axes = new_axes(5.2, 4.8)
    axes.plot([0, 1], [0, 1], color="#cccccc", linewidth=1)
    colours = iter(LINE_COLOURS * (1 + len(lines) // len(LINE_COLOURS)))
    greys = iter(("#555555", "#8a8a8a", "#aaaaaa") * (1 + len(lines)))
    dashes = iter(("--", "-.", ":") * (1 + len(lines)))
    for line in lines:
        colour = next(greys) if line.baseline else next(colours)
        name = line.name if line.auc is None else f"{line.name}  {line.auc:.3f}"
        style = next(dashes) if line.baseline else "-"
        axes.plot(*thin_curve(line.fpr, line.tpr), style, color=colour, linewidth=1.8, label=name)
        for point in line.points:
            face = "white" if point.filtered else colour
            axes.plot(point.fpr, point.tpr, "o", color=colour, markerfacecolor=face, markersize=6.5, zorder=5)
    axes.set(xlim=(-0.01, 1.01), ylim=(-0.01, 1.01), aspect="equal", title=title)
    axes.set(xlabel="false-positive rate (floor called obstacle)", ylabel="true-positive rate")
    if lines:
        any_auc = any(line.auc is not None for line in lines)
        axes.legend(
            frameon=False, loc="lower right", fontsize=8, title="AUC" if any_auc else None, alignment="left"
        )
    return figure


def reliability(
    p_above: Floats, above: NDArray[np.bool_], bins: int = 10
) -> tuple[Floats, Floats, NDArray[np.int64]]:
    """Mean prediction, share really above, and count per bin of predicted probability.

    Args:
        p_above: (n,) in [0, 1].
        above: (n,) whether the pixel is above the horizon.
        bins: of equal width.

    Returns:
        Three arrays (bins,); the first two NaN where a bin is empty.
    """
    found = Reliability(bins)
    found.update(p_above, above)
    return found.curve()


def reliability_figure(lines: Mapping[str, tuple[Floats, Floats]], title: str = "") -> "Figure":
    """Share really above against predicted `p_above`, one line (predicted, observed) a method."""
    figure, axes = new_axes(4.4, 4.2)
    axes.plot([0, 1], [0, 1], color="#cccccc", linewidth=1)
    colours = LINE_COLOURS * (1 + len(lines) // len(LINE_COLOURS))
    for (name, (predicted, observed)), colour in zip(lines.items(), colours, strict=False):
        axes.plot(predicted, observed, "o-", color=colour, linewidth=1.6, markersize=4, label=name)
    axes.set(xlim=(-0.01, 1.01), ylim=(-0.01, 1.01), aspect="equal", title=title)
    axes.set(xlabel="predicted p_above", ylabel="share really above the horizon")
    if lines:
        axes.legend(frameon=False, loc="upper left", fontsize=8)
    return figure


def figure_bytes(figure: "Figure", format: str = "svg") -> bytes:
    """The figure as the bytes of an `svg` or `png` file, without a date so that runs compare."""
    from matplotlib import rc_context

    buffer = io.BytesIO()
    metadata = {"Date": None} if format == "svg" else None
    with rc_context(_STYLE):
        figure.savefig(buffer, format=format, dpi=150, metadata=metadata)
    return buffer.getvalue()


def save_figure(path: Path, figure: "Figure") -> None:
    """Writes a figure as SVG or PNG by the path's ending."""
    write_bytes(path, figure_bytes(figure, "png" if path.suffix.lower() == ".png" else "svg"))
