"""What is not used is not loaded: torchvision and Lightning take longer to load than a prediction."""

import subprocess
import sys

HEAVY = ("lightning", "torchvision", "kornia", "sklearn", "matplotlib", "onnx")


def test_predicting_and_learning_online_load_torch_alone():
    modules = "horizon_dl.training.predict, horizon_dl.training.online.learner"
    code = f"import sys, {modules}; print(*({set(HEAVY)!r} & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=120)
    assert (done.stdout.split(), done.returncode) == ([], 0), done.stderr
