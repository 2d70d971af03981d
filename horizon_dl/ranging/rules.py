"""The rules of ranging, as a config's sections `ranging` and `contact` hold them."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from horizon_dl.params import angle_deg, read_params, setting
from horizon_dl.ranging.contact import ContactDetectorParams


@dataclass(frozen=True)
class RangingParams:
    """When a run of obstacle cells counts as an obstacle, and how sure its distance is.

    Attributes:
        extent_rad: height of the window in which obstacle cells must prevail; lower specks are no obstacle,
            lower gaps are bridged.
        share: share of the window's cells that must be obstacle.
        horizon_rad: an obstacle that comes this close to a vehicle's lowest part (that of a vehicle as low as
            its camera is at the horizon) reaches it.
        unseen_rad: this close to the horizon nothing is asked: there the attitude's error decides the side,
            and every map is unsure.
        cell_share: share of a cell's pixels that make it an obstacle cell; well under a half, for the sake of
            poles narrower than a sector.
        attitude_sd_rad: standard deviation of roll and pitch.
        height_sd: relative standard deviation of the height.
        rise: for `free_distances_from_p`; the window and its share are for maps.
    """

    extent_rad: float = angle_deg(1.5, 0.1, 30.0)
    share: float = setting(0.6, 0.01, 1.0)
    horizon_rad: float = angle_deg(2.0, 0.0, 30.0)
    unseen_rad: float = angle_deg(1.0, 0.0, 30.0)
    cell_share: float = setting(0.2, 0.01, 1.0)
    attitude_sd_rad: float = angle_deg(0.5, 0.0, 20.0)
    height_sd: float = setting(0.03, 0.0, 1.0)
    rise: ContactDetectorParams = field(default_factory=ContactDetectorParams)

    @classmethod
    def of_values(cls, config: Mapping[str, object]) -> "RangingParams":
        """From a config's sections `ranging` and `contact`, as in files; ValueError as of `read_params`."""
        contact = read_params(ContactDetectorParams, config.get("contact", {}), "contact")
        return replace(read_params(cls, config.get("ranging", {}), "ranging"), rise=contact)
