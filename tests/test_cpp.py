"""The C++ example, where a compiler and onnxruntime's headers are installed; the library is the wheel's."""

import os
import re
import shutil
import subprocess
from pathlib import Path

import numpy as np
import onnxruntime
import pytest
from PIL import Image
from small_run import model_file, toy_frames

SOURCE = Path(__file__).parent.parent / "exports" / "cpp" / "obstacles.cpp"
HEADER = "onnxruntime_cxx_api.h"
PLACES = (
    os.environ.get("ONNXRUNTIME_INCLUDE", ""),
    "/usr/include/onnxruntime",
    "/usr/local/include/onnxruntime",
)


@pytest.fixture(scope="module")
def program(tmp_path_factory) -> Path:
    compiler = shutil.which("g++") or shutil.which("clang++")
    headers = [place for place in PLACES if place and (Path(place) / HEADER).is_file()]
    libraries = sorted((Path(onnxruntime.__file__).parent / "capi").glob("libonnxruntime.so.*"))
    if not compiler:
        pytest.skip("there is no C++ compiler")
    if not headers:
        pytest.skip(
            f"{HEADER} is not installed (Debian: libonnxruntime-dev), nor named in ONNXRUNTIME_INCLUDE"
        )
    if not libraries:
        pytest.skip("this onnxruntime has its library inside its Python module")
    folder = tmp_path_factory.mktemp("cpp")
    for name in ("libonnxruntime.so", "libonnxruntime.so.1"):
        (folder / name).symlink_to(libraries[0])
    options = ["-O1", "-std=c++17", "-Wall", "-Wextra", "-I", headers[0], "-L", str(folder), "-lonnxruntime"]
    command = [compiler, str(SOURCE), *options, f"-Wl,-rpath,{folder}", "-o", str(folder / "obstacles")]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr
    assert "obstacles.cpp" not in done.stderr  # no warning in the example itself
    return folder / "obstacles"


@pytest.mark.slow
def test_it_says_what_the_library_says(program, model, tmp_path):
    frame = toy_frames()[1]
    wanted = model.predict(frame.image, frame.up_cam)
    Image.fromarray(frame.image).save(tmp_path / "picture.ppm")
    up_cam = [f"{part:.9g}" for part in frame.up_cam]
    out = tmp_path / "obstacles.pgm"
    command = [str(program), str(model_file()), str(tmp_path / "picture.ppm"), *up_cam, str(out)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stderr
    assert np.array_equal(np.asarray(Image.open(out)) > 0, wanted.obstacles)
    (entropy,) = re.findall(r"mean entropy (\S+) bits", done.stdout)
    assert float(entropy) == pytest.approx(float(wanted.entropy.mean()), abs=1e-4)


@pytest.mark.slow
def test_bad_input_is_one_line(program, tmp_path):
    (tmp_path / "picture.ppm").write_bytes(b"P6 4 4 255\n...")
    command = [str(program), str(model_file()), str(tmp_path / "picture.ppm"), "0", "-1", "0", "out.pgm"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60)
    assert done.returncode == 1
    assert "is cut off" in done.stderr
    assert done.stderr.count("\n") == 1
