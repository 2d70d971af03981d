"""The rules that a model is flown by: those of the config that it was exported with, from its card."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from horizon_dl.evidence.limits import EvidenceLimits
from horizon_dl.params import read_params
from horizon_dl.ranging.rules import RangingParams
from horizon_dl.vehicle.flight_params import FlightParams


@dataclass(frozen=True)
class FlightRules:
    """How ranging, evidence and watchdog decide.

    Attributes:
        ranging: when an obstacle's foot is found.
        evidence: what a frame and a sector must show.
        flight: watchdog and temporal filter.
    """

    ranging: RangingParams = field(default_factory=RangingParams)
    evidence: EvidenceLimits = field(default_factory=EvidenceLimits)
    flight: FlightParams = field(default_factory=FlightParams)

    @classmethod
    def of_card(cls, card: Mapping[str, Any]) -> "FlightRules":
        """From a card's `config`; the defaults for what an older card lacks.

        Raises:
            ValueError: a value that cannot be.

        Example:
            >>> FlightRules.of_card({}) == FlightRules()
            True
        """
        return cls.of_values(card.get("config") or {})

    @classmethod
    def of_values(cls, config: Mapping[str, Any]) -> "FlightRules":
        """From a config as files have it; see `of_card`."""
        return cls(
            RangingParams.of_values(config),
            read_params(EvidenceLimits, config.get("evidence", {}), "evidence"),
            read_params(FlightParams, config.get("flight", {}), "flight"),
        )
