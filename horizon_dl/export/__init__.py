"""From a trained net to one ONNX file.

The room is also the public function of its name: `from horizon_dl import export` gives it, whether or not a
module in it was loaded before, and it does what `export_run` does.
"""

import sys
from types import ModuleType
from typing import Any


class _Room(ModuleType):
    def __call__(self, *arguments: Any, **named: Any) -> Any:
        """See `export_run`."""
        from horizon_dl.export.export import export_run

        return export_run(*arguments, **named)


sys.modules[__name__].__class__ = _Room
