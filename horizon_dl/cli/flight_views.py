"""What `fly` shows and keeps of a flight: `--record`, and the viewers."""

import argparse
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from horizon_dl.data.source import FrameSource
    from horizon_dl.reporting.run_page import Page
    from horizon_dl.runtime.flight_loop import FlightLoop
    from horizon_dl.runtime.hot_reload import HotReloadedModel
    from horizon_dl.runtime.perception import Perception
    from horizon_dl.visualization.flight_view import FlightView


def open_view(
    arguments: argparse.Namespace,
    source: "FrameSource",
    flight: "FlightLoop",
    model: "HotReloadedModel",
    perception: "Perception",
) -> "FlightView | None":
    """The flight's film, page and viewers on their thread; None where nothing was asked for."""
    from horizon_dl.cli.viewers import open_viewers
    from horizon_dl.errors import InputError
    from horizon_dl.reporting.outputs import film_and_page
    from horizon_dl.reporting.run_page import FILM
    from horizon_dl.visualization.flight_view import FlightView
    from horizon_dl.visualization.sink import Sink, Sinks

    title = f"{arguments.model.name} over {source.name}"
    sinks: list[Sink] = []
    if arguments.record is not None:
        if (arguments.record / FILM).exists():
            raise InputError(arguments.record, "holds the film of an earlier flight", "give another --record")
        try:
            arguments.record.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            problem = f"cannot be written ({error.strerror})"
            raise InputError(arguments.record, problem, "give another --record") from None
        sinks += film_and_page(
            arguments.record, source, title, lambda page: _lead(page, flight), lambda: _facts(flight)
        )
    sinks += open_viewers(arguments, title, lambda: status(flight))
    if arguments.dds is not None:
        from horizon_dl.visualization.dds_sink import Dds, Network

        sinks.append(Dds(Network.parse(arguments.dds), arguments.min_distance, arguments.max_distance))
    if not sinks:
        return None
    view = FlightView(model, perception, Sinks(sinks))
    flight.on_look = view.look
    return view


def status(flight: "FlightLoop") -> dict[str, Any]:
    """The flight's figures now, in words."""
    latency, period = flight.latencies.summary(), flight.periods.summary()
    troubles = flight.watchdog.troubles()
    rate = period["median_ms"]
    return {
        "watchdog": "ready" if not troubles else "unknown: " + ", ".join(troubles),
        "messages a second": None if not rate else round(1000 / rate, 1),
        "from image to message": None
        if latency["median_ms"] is None
        else f"median {latency['median_ms']:.0f} ms, 99 % in {latency['p99_ms']:.0f} ms",
        "messages": message_words(flight.summary()),
        "pictures": f"{flight.looked_at} looked at, {flight.without_attitude} without attitude",
        "autopilot": f"{flight.autopilot.heartbeats} heartbeats",
    }


def message_words(figures: dict[str, Any]) -> str:
    """What became of the messages, of `FlightLoop.summary`."""
    messages, doubted = figures["messages"], figures["evidence"]["doubted_messages"]
    return (
        f"{messages['sent']} messages ({messages['unknown']} unknown, as something was late or missing; "
        f"{doubted} of pictures that were not believed; {messages['unsent']} did not leave)"
    )


def _lead(page: "Page", flight: "FlightLoop") -> str:
    """What became of the flight."""
    good = max(0, flight.sent - flight.unknown - flight.doubted)
    share = good / flight.sent if flight.sent else 0.0
    return (
        f"The loop looked at {flight.looked_at} pictures and sent {flight.sent} messages; in {share:.0%} of "
        f"them it could say where obstacles are. {page.frames} pictures were drawn."
    )


def _facts(flight: "FlightLoop") -> list[tuple[str, str]]:
    return [(name, str(value)) for name, value in status(flight).items() if value is not None]
