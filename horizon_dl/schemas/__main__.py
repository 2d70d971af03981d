"""Writes the JSON schemas of all files: `python -m horizon_dl.schemas docs/schemas`."""

import json
import sys
from pathlib import Path

from horizon_dl.schemas.base import Versioned
from horizon_dl.schemas.card import Card
from horizon_dl.schemas.check import Check
from horizon_dl.schemas.frames import FrameLine
from horizon_dl.schemas.metrics import Metrics
from horizon_dl.schemas.run import RunInfo

FILES: tuple[type[Versioned], ...] = (Metrics, RunInfo, Card, Check, FrameLine)


def schema_texts() -> dict[str, str]:
    """JSON schema as text by the file's name, such as `metrics.schema.json`."""
    return {
        f"{one.FILE.split('.')[0]}.schema.json": json.dumps(one.model_json_schema(), indent=1) + "\n"
        for one in FILES
    }


if __name__ == "__main__":
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in schema_texts().items():
        (folder / name).write_text(text)
