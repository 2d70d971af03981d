"""Public sets that horizon-dl reads, with their official hosts."""

from dataclasses import dataclass

from horizon_dl.errors import InputError


@dataclass(frozen=True)
class Archive:
    """One file to download.

    Attributes:
        url: at the official host.
        file: name it is saved under, ending in .zip, .tgz or .tar.gz.
        sha256: of the file, or None where nobody has published or confirmed one.
        inside: name of the archive within the archive that holds the set, where it is nested.
    """

    url: str
    file: str
    sha256: str | None = None
    inside: str | None = None


@dataclass(frozen=True)
class PublicSet:
    """One set.

    Attributes:
        name: what `fetch` is called with.
        what: one line.
        licence: as its owners state it.
        page: where its owners describe it.
        archives: what is downloaded; none for a set that is made here.
        megabytes: size of the download, or None where unknown.
        opens: folder within the fetched one that the other verbs are given.
    """

    name: str
    what: str
    licence: str
    page: str
    archives: tuple[Archive, ...] = ()
    megabytes: int | None = None
    opens: str = "."


_KITTI = "https://s3.eu-central-1.amazonaws.com/avg-kitti/raw_data"
_TUM = "https://cvg.cit.tum.de/rgbd/dataset"
_ETH = "https://www.research-collection.ethz.ch/server/api/core/bitstreams"
_EUROC_LICENCE = "in copyright, non-commercial use permitted (Burri et al. 2016)"
_EUROC_PAGE = "https://doi.org/10.3929/ethz-b-000690084"


def _kitti(drive: str, what: str, megabytes: int) -> PublicSet:
    date = "2011_09_26"
    stem = f"{date}_drive_{drive}"
    return PublicSet(
        name=f"kitti-{drive}",
        what=what,
        licence="CC BY-NC-SA 3.0 (Geiger et al. 2013)",
        page="https://www.cvlibs.net/datasets/kitti/raw_data.php",
        archives=(
            Archive(f"{_KITTI}/{date}_calib.zip", f"{date}_calib.zip"),
            Archive(f"{_KITTI}/{stem}/{stem}_sync.zip", f"{stem}_sync.zip"),
        ),
        megabytes=megabytes,
        opens=f"{date}/{stem}_sync",
    )


def _tum(name: str, group: str, what: str, megabytes: int | None, sha256: str | None) -> PublicSet:
    folder = f"rgbd_dataset_{group}_{name}"
    return PublicSet(
        name=f"tum-{group.replace('freiburg', 'fr')}-{name.replace('_', '-')}",
        what=what,
        licence="CC BY 4.0 (Sturm et al. 2012)",
        page="https://cvg.cit.tum.de/data/datasets/rgbd-dataset",
        archives=(Archive(f"{_TUM}/{group}/{folder}.tgz", f"{folder}.tgz", sha256),),
        megabytes=megabytes,
        opens=folder,
    )


_SETS = (
    PublicSet(
        name="simulated",
        what="a flight or walk through a random world, rendered here: horizon-dl data simulate --world NAME",
        licence="MIT, as this package",
        page="no download",
    ),
    _kitti("0001", "car in a town, 108 frames with IMU and lidar (the paper's drive)", 459),
    _kitti("0052", "car on a road with traffic, 78 frames with IMU and lidar", 286),
    _tum(
        "structure_notexture_far", "freiburg3", "hand-held RGB-D camera, panels without texture", None, None
    ),
    _tum(
        "xyz",
        "freiburg1",
        "hand-held RGB-D camera over a desk, 798 frames",
        449,
        "a0236d97b8c30cd93b653656d2b6c293ff7c982a4130ef2a1a8beecdb124ef98",
    ),
    PublicSet(
        name="euroc-mh-01",
        what="drone in a machine hall, grey images and IMU; all five flights come in one archive",
        licence=_EUROC_LICENCE,
        page=_EUROC_PAGE,
        archives=(
            Archive(
                f"{_ETH}/7b2419c1-62b5-4714-b7f8-485e5fe3e5fe/content",
                "machine_hall.zip",
                "5ed7d07903f8d19b6c8808e2ae8a0872b281f6e34ef5497023b8ac58c3de0f6f",
                inside="MH_01_easy.zip",
            ),
        ),
        megabytes=12_684,
    ),
    PublicSet(
        name="euroc-v1-01",
        what="drone in a room, grey images and IMU; all three flights come in one archive",
        licence=_EUROC_LICENCE,
        page=_EUROC_PAGE,
        archives=(
            Archive(
                f"{_ETH}/02ecda9a-298f-498b-970c-b7c44334d880/content",
                "vicon_room1.zip",
                "fe73c27be6dc8ac00493b78b750d36b144daf49eea7fdf3163e934527c1b5297",
                inside="V1_01_easy.zip",
            ),
        ),
        megabytes=6_043,
    ),
)


def list_sets() -> list[PublicSet]:
    """All known sets, in the order to show them."""
    return list(_SETS)


def find_set(name: str) -> PublicSet:
    """The set of that name.

    Raises:
        InputError: there is none.
    """
    for known in _SETS:
        if known.name == name:
            return known
    names = ", ".join(known.name for known in _SETS)
    raise InputError(name, "is not a known set", f"take one of {names}")
