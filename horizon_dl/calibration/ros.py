"""ROS camera_info: the file of the calibration tool, and what `rostopic echo` and `ros2 topic echo` print."""

from horizon_dl.calibration.candidate import Candidate, Found, Wanted
from horizon_dl.calibration.fields import Fields, Tree
from horizon_dl.calibration.lens_names import build_camera, lens_named, matrix_intrinsics, size_of
from horizon_dl.errors import InputError

NAME = "ROS camera_info"
MATRIX = ("camera_matrix", "K", "k")
COEFFICIENTS = ("distortion_coefficients", "D", "d")
SIZES = (("image_width", "image_height"), ("width", "height"))
_OWN = ("distortion_model", "camera_model", "camera_name", "projection_matrix", "binning_x")


def recognises(tree: Tree) -> bool:
    """Whether the fields are of this kind."""
    tree = _unwrapped(tree)
    return any(name in tree for name in MATRIX) and any(name in tree for name in _OWN)


def candidates(fields: Fields, wanted: Wanted) -> list[Candidate]:
    """Its one camera."""
    fields = Fields(fields.path, _unwrapped(fields.content))
    names = [name for name in (fields.text("camera_name"), "camera") if name]
    stated = any(fields.has(width) for width, _ in SIZES)
    return [
        Candidate(
            tuple(names), size_of(fields, None, SIZES) if stated else None, lambda: _found(fields, wanted)
        )
    ]


def _unwrapped(tree: Tree) -> Tree:
    """The message: some tools put it below its own name."""
    inner = tree.get("camera_info")
    return inner if isinstance(inner, dict) else tree


def _found(fields: Fields, wanted: Wanted) -> Found:
    _check_region(fields)
    intrinsics = matrix_intrinsics(fields, fields.first(MATRIX))
    size = size_of(fields, wanted.size, SIZES)
    name = fields.first(COEFFICIENTS)
    values = fields.numbers(name) if fields.has(name) else ()
    lens = _lens(fields, values)
    if lens == "radtan" and len(values) > 5:  # plumb_bob written with rational_polynomial's zeros
        lens = "rational"
    return Found(build_camera(fields, lens, size, intrinsics, values))


def _lens(fields: Fields, values: tuple[float, ...]) -> str:
    """The lens that the file states; never guessed where there are coefficients."""
    stated = {name: fields.text(name) for name in ("distortion_model", "camera_model") if fields.text(name)}
    lenses = {name: lens_named(fields, name, text) for name, text in stated.items()}
    bent = {name: lens for name, lens in lenses.items() if lens != "pinhole"}
    if len(set(bent.values())) > 1:
        both = " and ".join(f"{name} '{stated[name]}'" for name in bent)
        raise InputError(fields.path, f"states {both}, which are two lenses", "take the wrong one out")
    if bent:
        return next(iter(bent.values()))
    if any(values):
        raise InputError(
            fields.path,
            f"has {len(values)} distortion coefficients and states no lens model",
            "add 'distortion_model: plumb_bob' (or rational_polynomial, equidistant)",
        )
    return "pinhole"


def _check_region(fields: Fields) -> None:
    """InputError where the images are a part of what was calibrated, or binned."""
    roi = fields.content.get("roi")
    offsets = [roi.get(name) for name in ("x_offset", "y_offset")] if isinstance(roi, dict) else []
    binning = [fields.content.get(name) for name in ("binning_x", "binning_y")]
    if any(offsets) or any(value not in (None, 0, 1, 0.0, 1.0) for value in binning):
        raise InputError(
            fields.path,
            "is of images that are cut out or binned (roi, binning)",
            "calibrate the images as they are, or write K for them and set roi and binning to 0",
        )
