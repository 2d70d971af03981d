"""Joins all evidence: which sectors of a frame may be believed, and why not the others."""

from collections import Counter
from dataclasses import dataclass, field, fields, replace

import numpy as np
from numpy.typing import NDArray

from horizon_dl.evidence.appearance import FEATURES, appearance
from horizon_dl.evidence.damage import damage
from horizon_dl.evidence.exposure import exposure_problem
from horizon_dl.evidence.horizon_offset import OffsetWatch, horizon_offset
from horizon_dl.evidence.limits import LIMITS, EvidenceLimits
from horizon_dl.evidence.place import Place
from horizon_dl.evidence.reason import Reason
from horizon_dl.evidence.sectors import lost_pixels, sectors_without_evidence
from horizon_dl.evidence.sketch import sketch_of
from horizon_dl.evidence.stream import MotionWatch, Seen
from horizon_dl.geometry.camera import Camera
from horizon_dl.geometry.polar import PolarView
from horizon_dl.geometry.resize import area_resize
from horizon_dl.ranging.sectors import FreeDistances, Outcome, no_distances

Mask = NDArray[np.bool_]
HORIZON_ACCURACY = FEATURES.index("horizon_accuracy")


@dataclass(frozen=True)
class Judged:
    """The sectors of one frame as far as there is evidence for them.

    Attributes:
        found: sectors; unknown where evidence lacks.
        reasons: why the whole frame is not believed; empty if it is.
        sectors: how many sectors were taken back for each further reason.
        horizon_accuracy: of the net on this frame, in [0, 1]; NaN without a horizon in view.
        strangeness: of the picture, in ranges of the training pictures; NaN where they are not known.
    """

    found: FreeDistances
    reasons: tuple[Reason, ...] = ()
    sectors: dict[Reason, int] = field(default_factory=dict)
    horizon_accuracy: float = float("nan")
    strangeness: float = float("nan")

    @property
    def doubts(self) -> tuple[str, ...]:
        """Why the frame is not believed, or else some of its sectors."""
        return tuple(str(reason) for reason in self.reasons or self.sectors)


@dataclass
class Judge:
    """Looks at every frame of a flight, in its order.

    Attributes:
        camera: of the upright images.
        place: what the training pictures were like; None (an old file): nothing is believed.
        limits: see there.
        frames: counted by reason; "believed" where there was none.
        sectors: taken back in believed frames, by reason; "believed" for those that were kept.
    """

    camera: Camera
    place: Place | None
    limits: EvidenceLimits = field(default_factory=lambda: LIMITS)
    frames: Counter[str] = field(default_factory=Counter)
    sectors: Counter[str] = field(default_factory=Counter)
    _motion: MotionWatch = field(default_factory=MotionWatch)
    _offsets: OffsetWatch = field(default_factory=OffsetWatch)
    _proved_s: float = -np.inf

    def __post_init__(self) -> None:
        self._motion.limits = self._offsets.limits = self.limits

    def follow(self, place: Place | None, limits: EvidenceLimits) -> None:
        """Judge by what a fresh model file brings."""
        self.place, self.limits = place, limits
        self._motion.limits = self._offsets.limits = limits

    def judge(
        self,
        time_s: float,
        image: NDArray[np.uint8],
        up_cam: NDArray[np.float64],
        p_above: NDArray[np.float32],
        elevation: NDArray[np.float32],
        found: FreeDistances,
        polar: PolarView,
        *,
        doubts: tuple[Reason, ...] = (),
    ) -> Judged:
        """One frame.

        Args:
            time_s: of the picture, by the clock of the flight.
            image: (H, W, 3) uint8 RGB, as it came.
            up_cam: (3,) unit, the world's up in the optical frame.
            p_above: (h, w) of the net.
            elevation: (h, w) rad over the horizon.
            found: the sectors that follow from `p_above`.
            polar: the cells that they came from.
            doubts: why the frame is not to be believed, known beforehand.
        """
        judged = self.judge_picture(time_s, image, p_above, elevation, found, polar)
        seen = Seen(time_s, sketch_of(image), np.asarray(up_cam, np.float64))
        moved = self._motion_problem(seen)
        moves = () if moved is None else (moved,)
        reasons = (*doubts, *moves, *judged.reasons)
        # A picture that shows nothing cannot be compared with; a frozen one does not belong to its attitude.
        self._motion.remember(seen, believed=not reasons, frozen=moved is Reason.FROZEN)
        judged = replace(judged, reasons=reasons)
        self._count(judged)
        return replace(judged, found=no_distances(found.bearing_rad)) if reasons else judged

    def judge_picture(
        self,
        time_s: float,
        image: NDArray[np.uint8],
        p_above: NDArray[np.float32],
        elevation: NDArray[np.float32],
        found: FreeDistances,
        polar: PolarView,
    ) -> Judged:
        """What the picture tells, without its motion; nothing is counted."""
        small = working_image(image, p_above.shape)
        features = appearance(small, elevation, p_above, self.limits)
        strangeness = np.nan if self.place is None else self.place.strangeness(features)[0]
        accuracy = float(features[HORIZON_ACCURACY])
        reasons = [
            exposure_problem(sketch_of(image), self.limits),
            damage(image, self.limits),
            self._horizon_problem(time_s, accuracy),
            self._place_problem(strangeness),
        ]
        if not any(reasons):
            reasons.append(self._offset_problem(time_s, p_above, elevation))
        lost, unfamiliar = lost_pixels(small), None
        if self.place is not None:
            lost &= ~self.place.usually_flat(small)
            unfamiliar = self.place.unfamiliar(small)
        gone, strange = sectors_without_evidence(found, polar, lost, unfamiliar, self.limits)
        taken = {Reason.LOST: int(gone.sum()), Reason.FLOOR: int((strange & ~gone).sum())}
        return Judged(
            without(found, gone | strange),
            tuple(dict.fromkeys(reason for reason in reasons if reason is not None)),
            {reason: count for reason, count in taken.items() if count},
            accuracy,
            float(strangeness),
        )

    def summary(self) -> dict[str, dict[str, int]]:
        """Counts, ready for JSON."""
        return {"frames": dict(self.frames), "sectors": dict(self.sectors)}

    def _horizon_problem(self, time_s: float, accuracy: float) -> Reason | None:
        """A horizon out of view is bridged for a moment by what was proved before."""
        if np.isnan(accuracy):
            return None if time_s - self._proved_s <= self.limits.proof_s else Reason.NO_SKY
        least = self.limits.least_horizon_accuracy
        if self.place is not None:
            least = self.place.least_horizon_accuracy(self.limits)
        if accuracy < least:
            self._proved_s = -np.inf
            return Reason.HORIZON
        self._proved_s = time_s
        return None

    def _offset_problem(
        self, time_s: float, p_above: NDArray[np.float32], elevation: NDArray[np.float32]
    ) -> Reason | None:
        """Asked of good pictures alone: what cannot show a horizon says nothing of the attitude."""
        usual_rad = None if self.place is None else self.place.offset_rad
        return self._offsets.problem(time_s, horizon_offset(p_above, elevation, self.limits), usual_rad)

    def _place_problem(self, strangeness: float) -> Reason | None:
        if self.place is None:
            return Reason.NOT_CALIBRATED
        return Reason.PLACE if strangeness > self.limits.strangeness else None

    def _motion_problem(self, seen: Seen) -> Reason | None:
        found = self._motion.problem(self.camera, seen)
        still = self._motion.is_still(seen) and seen.time_s - self._motion.still_s > self.limits.still_s
        return Reason.FROZEN if found is None and still else found

    def _count(self, judged: Judged) -> None:
        self.frames.update([str(reason) for reason in judged.reasons] or ["believed"])
        if not judged.reasons:
            self.sectors.update({str(reason): count for reason, count in judged.sectors.items()})
            self.sectors["believed"] += int((judged.found.outcome != Outcome.UNKNOWN).sum())


def without(found: FreeDistances, unknown: Mask) -> FreeDistances:
    """The sectors with some of them unknown."""
    nothing = no_distances(found.bearing_rad)
    values = {
        one.name: np.where(unknown, getattr(nothing, one.name), getattr(found, one.name))
        for one in fields(FreeDistances)
        if one.name not in ("bearing_rad", "nearest_rad")
    }
    return replace(found, **values)


def working_image(image: NDArray[np.uint8], shape: tuple[int, ...]) -> NDArray[np.uint8]:
    """(h, w, 3) the picture at the working size, by area averaging, as the training pictures were."""
    if image.shape[:2] == tuple(shape):
        return image
    return area_resize(image, (shape[1], shape[0]))
