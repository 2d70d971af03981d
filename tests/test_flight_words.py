"""What a flight says of itself: messages of pictures that were not believed told nothing."""

from types import SimpleNamespace

import pytest

from horizon_dl.cli.flight_views import _lead, message_words


@pytest.mark.parametrize(
    ("sent", "unknown", "doubted", "share"),
    [(0, 0, 0, "0%"), (200, 0, 0, "100%"), (200, 20, 0, "90%"), (200, 20, 180, "0%"), (10, 6, 5, "0%")],
)
def test_the_page_counts_only_messages_that_told_something(
    sent: int, unknown: int, doubted: int, share: str
) -> None:
    flight = SimpleNamespace(sent=sent, unknown=unknown, doubted=doubted, looked_at=50)
    assert f"in {share} of them it could say" in _lead(SimpleNamespace(frames=9), flight)


def test_messages_are_told_by_what_became_of_them() -> None:
    figures = {
        "messages": {"sent": 200, "unknown": 20, "unsent": 3},
        "evidence": {"doubted_messages": 150},
    }
    assert message_words(figures) == (
        "200 messages (20 unknown, as something was late or missing; 150 of pictures that were not believed; "
        "3 did not leave)"
    )
