"""`run.json` of a run folder: what a net was trained on, and its threshold."""

from typing import ClassVar, Literal

from pydantic import Field

from horizon_dl.schemas.base import Part, Versioned


class CameraFields(Part):
    """Intrinsics of the upright images; see `horizon_dl.geometry.camera.Camera`."""

    model: str
    width: int = Field(gt=0)
    height: int = Field(gt=0)
    fx: float
    fy: float
    cx: float
    cy: float
    distortion: tuple[float, ...] = ()


class RunInfo(Versioned):
    """The whole file."""

    FILE: ClassVar[str] = "run.json"

    schema_: int = Field(default=1, alias="schema")
    data: str
    format: str
    camera: CameraFields
    frames: int
    start: Literal["simulated", "random"] | None = None
    train_s: float
    threshold: float = Field(ge=0.0, le=1.0)
    threshold_rule: str
    simulated_threshold: float | None = Field(default=None, ge=0.0, le=1.0, allow_inf_nan=False, strict=True)
    path_agreement: float | None = Field(default=None, ge=-1.0, le=1.0, allow_inf_nan=False, strict=True)
