"""`card.json`, which also lies inside a model file.

What flies reads the card without this module: `runtime.model` checks the few keys that it uses.
"""

from typing import Any, ClassVar

from pydantic import Field

from horizon_dl.schemas.base import Part, Versioned
from horizon_dl.schemas.run import CameraFields


class CardThreshold(Part):
    """The paper's: the entropy over which a pixel is an obstacle of its map."""

    value: float = Field(ge=0.0, le=1.0)
    unit: str
    rule: str | None


class Card(Versioned):
    """The whole file."""

    FILE: ClassVar[str] = "card.json"

    schema_: int = Field(default=1, alias="schema")
    kind: str
    learner: str
    what: str
    camera: CameraFields
    image_size: tuple[int, int]
    working_size: tuple[int, int]
    inputs: dict[str, str]
    outputs: dict[str, str]
    threshold: CardThreshold
    config: dict[str, Any]
    trained_on: dict[str, Any]
    false_positive_rate: float | None = None
    path_agreement: float | None = Field(default=None, ge=-1.0, le=1.0, allow_inf_nan=False, strict=True)
