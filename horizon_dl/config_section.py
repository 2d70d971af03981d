"""A parameter class as a section of the configuration, checked field by field like all others."""

from typing import Annotated, Any

from pydantic import ConfigDict, Field, GetCoreSchemaHandler, create_model
from pydantic_core import CoreSchema, core_schema

from horizon_dl.params import read_params, settings_of, values_of


class AsSection:
    """Stands in `Annotated[Params, AsSection()]`; names, ranges and defaults are the class's."""

    def __get_pydantic_core_schema__(self, source: Any, _: GetCoreSchemaHandler) -> CoreSchema:
        """Check by a model made from the class; pydantic calls this once."""
        checks: dict[str, Any] = {
            one.name: (Annotated[one.kind, Field(ge=one.low, le=one.high)], one.default)
            for one in settings_of(source)
        }
        strict = ConfigDict(extra="forbid", allow_inf_nan=False)
        model = create_model(source.__name__, __config__=strict, **checks)

        def check(value: Any) -> Any:
            if isinstance(value, source):
                return value
            if not isinstance(value, dict):
                raise ValueError("is no section of values")
            return read_params(source, model.model_validate(value).model_dump(), source.__name__)

        return core_schema.no_info_plain_validator_function(
            check, serialization=core_schema.plain_serializer_function_ser_schema(values_of)
        )
