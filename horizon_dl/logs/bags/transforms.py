"""The tree of frames that `tf` and `tf_static` tell: how one frame is turned against another at a time."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from horizon_dl.data.doubt import Doubt
from horizon_dl.geometry.attitude import MAX_GAP_S, interpolate, rotation_from_quaternion
from horizon_dl.logs.bags.messages import decoder, frame_name, header_of
from horizon_dl.logs.bags.storage import Bag

Floats = NDArray[np.float64]

KINDS = ("tf2_msgs/msg/TFMessage", "tf/msg/tfMessage")
MOST_LINKS = 100
"""A longer chain is a circle."""


@dataclass(frozen=True)
class Link:
    """How a frame is turned in its parent.

    Attributes:
        parent: name of the frame above.
        times_s: (N,) sorted.
        quaternions: (N, 4) unit, (w, x, y, z), child to parent.
    """

    parent: str
    times_s: Floats
    quaternions: Floats

    @property
    def constant(self) -> bool:
        """Whether it never turns: static, or said again and again."""
        return bool((np.abs(self.quaternions @ self.quaternions[0]) > 1 - 1e-9).all())

    def rotation(self, time_s: float) -> Floats | None:
        """(3, 3) child to parent; None where nothing near in time is known."""
        if self.constant:
            return rotation_from_quaternion(self.quaternions[0])
        turned = interpolate(self.times_s, self.quaternions, time_s, MAX_GAP_S)
        return None if turned is None else rotation_from_quaternion(turned)


@dataclass(frozen=True)
class TransformTree:
    """The links by the name of the lower frame.

    Attributes:
        links: by the child's name.
        notes: on frames that are said to have two parents, of which the first is taken.
    """

    links: dict[str, Link]
    notes: tuple[str, ...] = ()

    def chain(self, frame: str) -> list[str]:
        """The frame and all above it, the root last."""
        names = [frame]
        while names[-1] in self.links and len(names) < MOST_LINKS:
            names.append(self.links[names[-1]].parent)
        return names

    def connected(self, first: str, second: str) -> bool:
        """Whether the turn between two frames is known at some time."""
        return first == second or self.chain(first)[-1] == self.chain(second)[-1]

    def constant(self, first: str, second: str) -> bool:
        """Whether two connected frames never turn against each other."""
        mine, other = self.chain(first), self.chain(second)
        between = set(mine) ^ set(other)
        return all(self.links[name].constant for name in between if name in self.links)

    def rotation(self, target: str, source: str, time_s: float) -> Floats | None:
        """(3, 3) that turns vectors of `source` into `target`; None where it is not known then."""
        if target == source:
            return np.eye(3)
        above = self.chain(target)
        common = next((name for name in self.chain(source) if name in above), None)
        if common is None:
            return None
        down, up = (self._to(common, frame, time_s) for frame in (target, source))
        return None if down is None or up is None else np.asarray(down.T @ up)

    def _to(self, ancestor: str, frame: str, time_s: float) -> Floats | None:
        turned = np.eye(3)
        for name in self.chain(frame):
            if name == ancestor:
                return turned
            step = self.links[name].rotation(time_s)
            if step is None:
                return None
            turned = step @ turned
        return None


def read_transforms(bag: Bag) -> TransformTree:
    """All of the bag's transforms; an empty tree where there are none."""
    samples: dict[str, list[tuple[float, tuple[float, ...]]]] = {}
    parents: dict[str, str] = {}
    refused: dict[str, str] = {}
    for topic in bag.topics.values():
        if topic.kind in KINDS and topic.count:
            decode = decoder(bag, topic)
            for _, payload in bag.messages(topic):
                for one in decode(payload).transforms:
                    _add(one, samples, parents, refused)
    links = {}
    for child, rows in samples.items():
        rows.sort(key=lambda row: row[0])
        quaternions = np.array([row[1] for row in rows])
        links[child] = Link(parents[child], np.array([row[0] for row in rows]), quaternions)
    notes = [
        Doubt(f"tf gives {child} two parents, {parents[child]} and {other}: the first is taken")
        for child, other in refused.items()
    ]
    return TransformTree(links, tuple(notes))


def _add(
    one: Any,
    samples: dict[str, list[tuple[float, tuple[float, ...]]]],
    parents: dict[str, str],
    refused: dict[str, str],
) -> None:
    turned = one.transform.rotation
    quaternion = np.array([turned.w, turned.x, turned.y, turned.z])
    norm = float(np.linalg.norm(quaternion))
    time_s, parent = header_of(one)
    child = frame_name(one.child_frame_id)
    if not 0.5 < norm < 2.0:
        return
    if parents.setdefault(child, parent) != parent:
        refused[child] = parent
        return
    samples.setdefault(child, []).append((time_s, tuple((quaternion / norm).tolist())))
