"""The configuration: one tree of checked values, read from a commented YAML file."""

from collections.abc import Sequence
from dataclasses import is_dataclass, replace
from math import radians
from pathlib import Path
from typing import Annotated, Any, Literal

import yaml
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from horizon_dl.config_file import builtin_config, keys_with_meaning
from horizon_dl.config_section import AsSection
from horizon_dl.data.safe_yaml import brief, parse_yaml, read_yaml
from horizon_dl.errors import InputError, shortened
from horizon_dl.evidence.limits import EvidenceLimits
from horizon_dl.nearest_word import meant
from horizon_dl.ranging.contact import ContactDetectorParams
from horizon_dl.ranging.rules import RangingParams
from horizon_dl.targets.geodesic_params import GeodesicParams
from horizon_dl.vehicle.flight_params import FlightParams

Share = Annotated[float, Field(ge=0.0, lt=1.0)]
Positive = Annotated[float, Field(gt=0.0)]
# The upper limits are far above any real use: they keep a slip of the keyboard from taking all memory.
Count = Annotated[int, Field(ge=1, le=10**9)]
Few = Annotated[int, Field(ge=1, le=4096)]


class Section(BaseModel):
    """A part of the configuration; an unknown key is an error, not a silent typo."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


class ImageConfig(Section):
    """At which size everything is computed."""

    max_pixels: Annotated[int, Field(ge=1024, le=10**8)] = 76_800


class LabelConfig(Section):
    """The horizon label."""

    band_deg: Annotated[float, Field(ge=0.0, le=45.0)] = 1.0

    @property
    def band_rad(self) -> float:
        """Half the height of the ignored band, rad."""
        return radians(self.band_deg)


class TargetConfig(Section):
    """What the net is trained on."""

    kind: Literal["hard", "guided", "one_way_geodesic", "geodesic"] = "geodesic"


class ModelConfig(Section):
    """The net and its dropout."""

    kind: Literal["fcn", "mobilenet_v3_small", "resnet18"] = "fcn"
    start: Literal["simulated", "random"] = "simulated"
    channels: Few = 32
    dropout: Share = 0.25
    samples: Few = 16


class TrainConfig(Section):
    """Training with the Lightning trainer."""

    rounds: tuple[Count, ...] = Field(default=(150, 100, 300), min_length=1, max_length=1000)
    batch: Few = 12
    crop: Annotated[int, Field(ge=32, le=10**5)] = 96
    pastes: Annotated[int, Field(ge=0, le=100)] = 3
    context_agreement: Annotated[float, Field(ge=-1.0, le=2.0)] = 0.8
    context_batch: Few = 8
    context_crop: Annotated[int, Field(ge=32, le=10**5)] = 128
    simulated_share: Annotated[float, Field(ge=0.0, le=1.0)] = 0.8
    learning_rate: Positive = 0.003
    weight_decay: Annotated[float, Field(ge=0.0)] = 0.0001
    average_decay: Share = 0.98
    crops_per_frame: Count = 8
    memory_mb: Count = 1024


class TrainerConfig(Section):
    """Lightning's trainer: on what it runs."""

    accelerator: str = "auto"
    devices: Count | Literal["auto"] = 1
    num_nodes: Count = 1
    strategy: Literal["auto", "ddp"] = "auto"


class OnlineConfig(Section):
    """Learning from a stream, one pass."""

    warm_up_frames: Annotated[int, Field(ge=0, le=10**9)] = 20
    warm_up_steps: Count = 12
    steps_per_frame: Count = 2
    batch: Annotated[int, Field(ge=2, le=4096)] = 6
    crop: Annotated[int, Field(ge=32, le=10**5)] = 128
    learning_rate: Positive = 0.003
    half_rate_steps: Count = 300
    least_rate: Positive = 0.0003
    memory_mb: Annotated[float, Field(gt=0.0, le=1e6)] = 64.0
    checkpoint_frames: Count = 300
    checkpoint_s: Positive = 30.0


class ForestConfig(Section):
    """The paper's random forest."""

    trees: Few = 20
    min_samples_leaf: Count = 10
    training_pixels: Count = 400_000


class ThresholdConfig(Section):
    """How the obstacle map's threshold is chosen; never from obstacle labels."""

    percentile: Annotated[float, Field(gt=0.0, lt=100.0)] = 25.0


class LoggerConfig(Section):
    """Where the curves of a training go: one of Lightning's loggers."""

    kind: Literal["tensorboard", "csv", "mlflow", "wandb", "none"] = "tensorboard"
    options: dict[str, Any] = {}


class Config(Section):
    """The whole configuration."""

    seed: Annotated[int, Field(ge=0, lt=2**31)] = 0
    image: ImageConfig = ImageConfig()
    labels: LabelConfig = LabelConfig()
    target: TargetConfig = TargetConfig()
    geodesic: Annotated[GeodesicParams, AsSection()] = GeodesicParams()
    model: ModelConfig = ModelConfig()
    train: TrainConfig = TrainConfig()
    trainer: TrainerConfig = TrainerConfig()
    online: OnlineConfig = OnlineConfig()
    forest: ForestConfig = ForestConfig()
    threshold: ThresholdConfig = ThresholdConfig()
    contact: Annotated[ContactDetectorParams, AsSection()] = ContactDetectorParams()
    ranging: Annotated[RangingParams, AsSection()] = RangingParams()
    evidence: Annotated[EvidenceLimits, AsSection()] = EvidenceLimits()
    flight: Annotated[FlightParams, AsSection()] = FlightParams()
    logger: LoggerConfig = LoggerConfig()

    @property
    def ranging_params(self) -> RangingParams:
        """`ranging` with `contact`: all that turns a frame into distances."""
        return replace(self.ranging, rise=self.contact)

    def changed(self) -> dict[str, Any]:
        """Values that are not the built-in ones, by dotted key.

        Example:
            >>> Config(train=TrainConfig(batch=4)).changed()
            {'train.batch': 4}
        """
        ours, default = _leaves(self), _leaves(Config())
        return {key: value for key, value in ours.items() if value != default[key]}


def _leaves(config: Config) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for name, value in config:
        if isinstance(value, Section):
            found |= {f"{name}.{key}": one for key, one in value}
        elif is_dataclass(value):
            found |= {f"{name}.{key}": one for key, one in vars(value).items()}
        else:
            found[name] = value
    return found


def load_config(source: str | Path | None = None, overrides: Sequence[str] = ()) -> Config:
    """Read a config and put dotted overrides on top.

    Args:
        source: a YAML file, the name of a built-in config, or None for `default`.
        overrides: `section.key=value` each, the value in YAML.

    Raises:
        InputError: the file cannot be read, or a key or value is wrong.
    """
    where = str(source or "default")
    path = Path(where) if Path(where).suffix in {".yaml", ".yml"} else builtin_config(where)
    return _checked(where, _read_yaml(path), overrides)


def changed_config(config: Config, overrides: Sequence[str]) -> Config:
    """A config with dotted overrides on top; errors as of `load_config`."""
    return _checked("config", config.model_dump(mode="json"), overrides) if overrides else config


def _checked(where: str, tree: dict[str, Any], overrides: Sequence[str]) -> Config:
    for override in overrides:
        _put(tree, override)
    try:
        return Config.model_validate(tree)
    except ValidationError as error:
        raise InputError(where, _first_problem(error), "`horizon-dl config show` lists all keys") from None


def save_config(config: Config, path: Path) -> None:
    """Write the resolved values as YAML."""
    path.write_text(yaml.safe_dump(config.model_dump(mode="json"), sort_keys=False))


def _read_yaml(path: Path) -> dict[str, Any]:
    try:
        tree = read_yaml(path)
    except FileNotFoundError:
        problem = "cannot be read (No such file or directory)"
        raise InputError(path, problem, "give a YAML file, or the name of a built-in config") from None
    if not isinstance(tree, dict):
        raise InputError(path, "holds no sections", "start from `horizon-dl config copy default`")
    return tree


def _put(tree: dict[Any, Any], override: str) -> None:
    dotted, _, value = override.partition("=")
    *sections, key = dotted.split(".")
    for section in sections:
        tree = tree.setdefault(section, {})
        if not isinstance(tree, dict):
            raise InputError(f"--{dotted}", f"'{section}' is a value, not a section", "see `config show`")
    try:
        tree[key] = parse_yaml(value)
    except ValueError as error:
        raise InputError(f"--{dotted}", f"its value {error}", "quote it, as in 'KEY=[1, 2]'") from None


def _first_problem(error: ValidationError) -> str:
    detail = error.errors(include_url=False)[0]
    key = shortened(".".join(str(part) for part in detail["loc"]), 200)
    if detail["type"] == "extra_forbidden":
        return f"has no key '{key}'{meant(key, (name for name, _, _ in keys_with_meaning()))}"
    if detail["type"] == "value_error":
        return f"{key}: {detail['ctx']['error']}"
    if detail["type"] == "missing":
        return f"lacks the key '{key}'"
    return f"{key} = {brief(detail['input'])}: {detail['msg'][0].lower()}{detail['msg'][1:]}"
