"""The frame browser's frame in HTML; the page's script fills it."""

from typing import TYPE_CHECKING

from horizon_dl.reporting.markup import Html, el

if TYPE_CHECKING:
    from horizon_dl.reporting.sections import Browser


def browser_html(section: "Browser") -> Html:
    """Controls, empty cells, and a line for those without a script."""
    methods = section.data["methods"]
    choose = el(
        "label",
        "learner ",
        el("select", *(el("option", one["name"], value=one["key"]) for one in methods), id="method"),
        hidden=len(methods) < 2,
    )
    order = el(
        "label",
        "frames ",
        el(
            "select",
            el("option", "all, by time", value="all"),
            el("option", "worst first", value="worst"),
            el("option", "the worst ten", value="ten"),
            id="order",
        ),
        hidden=not section.facts,
    )
    steps = el(
        "div",
        el("button", "◀", type="button", id="previous", aria_label="previous frame"),
        el("input", type="range", id="frame", min=0, max=0, value=0, aria_label="frame"),
        el("button", "▶", type="button", id="next", aria_label="next frame"),
        class_="steps",
    )
    slider = el(
        "div",
        el("label", "threshold of the entropy ", el("output", "", id="threshold-value"), for_="threshold"),
        el("input", type="range", id="threshold", min=0, max=1, value=0),
        el("button", "the paper's", type="button", id="own-threshold"),
        class_="threshold",
    )
    return el(
        "section",
        el("div", order, choose, steps, class_="controls"),
        el("p", "", id="frame-title", aria_live="polite"),
        el("div", "", id="cells"),
        slider,
        el("p", "", id="rates", aria_live="polite"),
        el(
            "p", "Arrow keys left and right: frames; up and down: threshold; a click enlarges.", class_="hint"
        ),
        el("noscript", el("p", "The frames need JavaScript; the panels folder holds them as pictures.")),
        el("dialog", el("button", "close", type="button", id="close"), el("div", "", id="large"), id="zoom"),
        class_="browser",
        aria_label="Frames",
        id="browser",
    )
