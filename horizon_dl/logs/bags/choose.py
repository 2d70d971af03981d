"""Which of a bag's topics are taken: by content, or as named where several fit."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import islice
from typing import Any

from horizon_dl.errors import InputError
from horizon_dl.logs.bags.attitudes import IMU, KINDS, Orientations, oriented, read_orientations
from horizon_dl.logs.bags.camera_info import KIND as INFO
from horizon_dl.logs.bags.camera_info import base_topic
from horizon_dl.logs.bags.frames import is_body
from horizon_dl.logs.bags.linked import Linked, transform_series
from horizon_dl.logs.bags.messages import decoder
from horizon_dl.logs.bags.pixels import is_depth
from horizon_dl.logs.bags.storage import Bag, Topic
from horizon_dl.logs.bags.transforms import TransformTree
from horizon_dl.logs.bags.up_series import Felt, Turned, imu_series, joined_imu, orientation_series

IMAGES = ("sensor_msgs/msg/Image", "sensor_msgs/msg/CompressedImage")
LOOKED_AT = 50
"""First messages of a topic: a driver may send some before it knows its orientation."""
AFTER_TRANSFORMS = len(KINDS) + 1

Series = Turned | Felt | Linked


def check_named(bag: Bag, named: Sequence[str]) -> None:
    """InputError where --topic names what is not there, or nothing that is of use."""
    for name in named:
        topic = bag.topics.get(name)
        if topic is None or topic.kind not in (*IMAGES, INFO, *KINDS):
            useful = [one.name for one in bag.topics.values() if one.kind in (*IMAGES, INFO, *KINDS)]
            problem = "is not in the bag" if topic is None else f"is of {topic.kind}, which says nothing here"
            hint = f"choose from {_listed(useful)}" if useful else "no topic is of use"
            raise InputError(f"--topic {name}", problem, hint)


def first_message(bag: Bag, topic: Topic) -> Any:
    """The first message of a topic that can be read, among its first ones.

    Raises:
        InputError: there is none, though the bag's index counts some.
    """
    decode = decoder(bag, topic)
    problem = InputError(bag.path, f"holds no message of {topic.name}", "it was cut off; copy it again")
    for _, raw in islice(bag.messages(topic), LOOKED_AT):
        try:
            return decode(raw)
        except InputError as error:
            problem = error
    raise problem


def image_topic(bag: Bag, named: Sequence[str]) -> Topic:
    """The topic with the pictures: named, or the only one; of two with the same, the fuller, else the raw.

    Raises:
        InputError: none, or several fit.
    """
    images = [topic for topic in bag.topics.values() if topic.kind in IMAGES and topic.count]
    chosen = [topic for topic in images if topic.name in named]
    seen = chosen or [topic for topic in images if not is_depth(first_message(bag, topic))]
    if not seen:
        depth = f"; only depth in {_listed([one.name for one in images])}" if images else ""
        kinds = sorted({topic.kind for topic in bag.topics.values() if topic.count})
        problem = f"holds no pictures{depth or ', only ' + _listed(kinds)}"
        raise InputError(bag.path, problem, "record an Image or CompressedImage topic")
    cameras: dict[str, Topic] = {}
    for topic in sorted(seen, key=lambda one: (-one.count, len(one.name))):
        cameras.setdefault(base_topic(topic.name), topic)
    if len(cameras) > 1:
        raise _several(bag, "pictures", [one.name for one in cameras.values()])
    return next(iter(cameras.values()))


@dataclass(frozen=True)
class _Candidate:
    topic: Topic
    frame: str
    rank: tuple[bool, int]


def up_series(
    bag: Bag, tree: TransformTree, camera_frame: str, named: Sequence[str], arrivals: bool = False
) -> Series | None:
    """What tells the attitude best: of what hangs together with the camera, and orientations before an IMU's.

    Args:
        bag: the bag.
        tree: its transforms.
        camera_frame: frame of the pictures.
        named: topics that the user chose.
        arrivals: go by the times of arrival, not by the headers'.

    Raises:
        InputError: several topics fit equally well.
    """
    topics = [topic for topic in bag.topics.values() if topic.kind in KINDS and topic.count]
    chosen = [topic for topic in topics if topic.name in named]
    candidates = [_candidate(bag, tree, camera_frame, topic) for topic in chosen]
    problems: list[InputError] = []
    if not chosen:
        candidates = _readable(bag, tree, camera_frame, topics, problems)
    linked = None if chosen else transform_series(tree, camera_frame)
    for rank in sorted({one.rank for one in candidates} | ({(False, len(KINDS))} if linked else set())):
        if linked and rank == (False, len(KINDS)):
            return linked
        equal = [one for one in candidates if one.rank == rank]
        best = _one_of(bag, tree, [one.topic for one in equal])
        series = orientation_series(best, arrivals) or imu_series(best, arrivals)
        if series is not None:
            return replace(series, frame=best.frame)
    if problems:
        raise problems[0]
    return None


def _one_of(bag: Bag, tree: TransformTree, topics: Sequence[Topic]) -> Orientations:
    """The only topic's attitudes, or of two IMUs that are one, apart; InputError for several."""
    found = []
    if len(topics) == 1 or (len(topics) == 2 and all(topic.kind == IMU for topic in topics)):
        found = [read_orientations(bag, topic) for topic in topics]
    joined = joined_imu(found[0], found[1], tree) if len(found) == 2 else None
    if len(topics) > 1 and joined is None:
        raise _several(bag, "attitudes", [topic.name for topic in topics])
    return joined or found[0]


def _readable(
    bag: Bag, tree: TransformTree, camera_frame: str, topics: Sequence[Topic], problems: list[InputError]
) -> list[_Candidate]:
    """The topics whose messages can be read; the others' `problems` are told where none of these does."""
    found = []
    for topic in topics:
        try:
            found.append(_candidate(bag, tree, camera_frame, topic))
        except InputError as error:
            problems.append(error)
    return found


def _candidate(bag: Bag, tree: TransformTree, camera_frame: str, topic: Topic) -> _Candidate:
    decode = decoder(bag, topic)
    first = [
        oriented(decode(raw), KINDS[topic.kind]) for _, raw in islice(bag.messages(topic), LOOKED_AT)
    ] or [oriented(first_message(bag, topic), KINDS[topic.kind])]
    frame = first[0][1]
    connected = bool(frame and camera_frame) and tree.connected(frame, camera_frame)
    if not frame and any(is_body(name) for name in tree.chain(camera_frame)):
        connected = True
    known = any(any(quaternion) for quaternion, _ in first)
    return _Candidate(
        topic, frame, (not connected, list(KINDS).index(topic.kind) if known else AFTER_TRANSFORMS)
    )


def body_frame(tree: TransformTree, camera_frame: str) -> str | None:
    """The robot's own frame above the camera; None where the transforms have none."""
    return next((name for name in tree.chain(camera_frame) if is_body(name)), None)


def _several(bag: Bag, what: str, names: Sequence[str]) -> InputError:
    return InputError(bag.path, f"holds {what} in {_listed(names)}", f"choose with --topic {names[0]}")


def _listed(names: Sequence[str]) -> str:
    shown = ", ".join(names[:12]) or "nothing"
    return f"{shown} and {len(names) - 12} more" if len(names) > 12 else shown
