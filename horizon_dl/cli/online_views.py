"""What `online` shows and keeps of a run: film, page and viewers."""

import argparse
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from horizon_dl.online.run import OnlineRun
    from horizon_dl.reporting.run_page import Page
    from horizon_dl.visualization.sink import Sink

MOST_FILMED = 1200
"""Of a longer recording every second, third, ... frame is drawn: a film of minutes is what people look at."""


def open_views(arguments: argparse.Namespace, online: "OnlineRun") -> None:
    """Give the run its sinks; in real time they are on a thread, and learning has the first say."""
    from horizon_dl.cli.viewers import open_viewers
    from horizon_dl.reporting.outputs import film_and_page
    from horizon_dl.reporting.run_page import FILM
    from horizon_dl.visualization.newest_only import NewestOnly
    from horizon_dl.visualization.sink import Sinks

    source = online.source
    title = f"Learning online from {source.name}"
    sinks: list[Sink] = []
    if not arguments.no_film:
        # A run that goes on leaves the film of what came before.
        film = f"film-from-{online.position:06d}.mp4" if online.position else FILM
        sinks += film_and_page(
            online.folder, source, title, lambda page: _lead(page, online), lambda: _facts(online), film
        )
    sinks += open_viewers(arguments, title, lambda: status(online))
    if sinks:
        in_time = arguments.real_time or source.live
        together = Sinks(sinks)
        online.sink = NewestOnly(together) if in_time else together
        if not in_time and source.length:
            online.show_every = -(-source.length // MOST_FILMED)


def status(online: "OnlineRun") -> dict[str, Any]:
    """The run's figures now, in words."""
    figures = online.figures
    pooled, within = figures.auc()
    accuracy = figures.sides.compute()["horizon_accuracy"]
    reasons = ", ".join(f"{count} {reason}" for reason, count in figures.reasons.most_common())
    return {
        "frames": f"{figures.seen} seen, {figures.learned} learned from",
        "left out": reasons or "none",
        "rate": None if online.rate_hz is None else f"{online.rate_hz:.1f} frames a second",
        "horizon accuracy, last 50": None if accuracy is None else f"{accuracy:.3f}",
        "AUC before learning": None if pooled is None else f"{pooled:.3f}, within bands {within:.3f}",
        "prediction": None
        if not figures.predicted
        else f"{1e3 * figures.accumulator.predict_s / figures.predicted:.0f} ms a frame",
    }


def _lead(page: "Page", online: "OnlineRun") -> str:
    """What was learned, and how well it went before it was."""
    figures = online.figures
    pooled, within = figures.auc()
    words = (
        f"The net saw {figures.seen} frames of {online.source.name}, each predicted before it was learned "
        f"from, and learned from {figures.learned}."
    )
    if pooled is not None and within is not None:
        words += f" AUC of its entropy {pooled:.3f} pooled, {within:.3f} within depression bands"
        words += "." if within > 0.6 else ": within the bands hardly more than position alone."
    if online.stopped:
        words += " It was stopped; the same command goes on."
    return words


def _facts(online: "OnlineRun") -> list[tuple[str, str]]:
    return [(name, str(value)) for name, value in status(online).items() if value is not None]
