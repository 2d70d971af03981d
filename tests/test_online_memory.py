"""Replay: bounded, compressed, diverse, and the same after a restart."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from horizon_dl.config import Config
from horizon_dl.geometry.resize import halved
from horizon_dl.readers.registry import open_recording
from horizon_dl.training.checkpoint import Snapshot, read_checkpoint, write_checkpoint
from horizon_dl.training.crops import TrainingFrame
from horizon_dl.training.frame_store import FrameStore
from horizon_dl.training.half_resolution import doubled, half_resolution_frame
from horizon_dl.training.online.compression import pack, unpack, unpack_elevation
from horizon_dl.training.online.replay_buffer import ReplayBuffer

SHAPE = (40, 50)


def smooth_frame(seed: int) -> TrainingFrame:
    """A frame unlike any of another seed, in about the bytes of any other."""
    rng = np.random.default_rng(seed)
    rows, columns = np.mgrid[: SHAPE[0], : SHAPE[1]] / 50
    image = np.stack([rng.uniform(0, 255) + 30 * np.sin(3 * rows + c + columns) for c in range(3)], axis=-1)
    return TrainingFrame(
        image.clip(0, 255).astype(np.uint8),
        doubled(rng.random((SHAPE[0] // 2, SHAPE[1] // 2)).astype(np.float16), SHAPE),
        rng.random(SHAPE) < 0.8,
    )


ANGLES = np.linspace(-0.9, 0.9, (SHAPE[0] // 2) * (SHAPE[1] // 2), dtype=np.float32)
ANGLES = ANGLES.reshape(SHAPE[0] // 2, SHAPE[1] // 2)


def test_packing_keeps_the_elevation_with_its_gaps():
    angles = ANGLES.copy()
    angles[0, :3] = np.nan
    found = unpack_elevation(pack(smooth_frame(0), angles))
    assert np.array_equal(found, angles.astype(np.float16), equal_nan=True)
    np.testing.assert_allclose(found, angles, rtol=1e-3)


def test_the_oldest_target_is_made_anew():
    memory = ReplayBuffer(10, np.random.default_rng(0))
    for number, made_at in enumerate((5, -1, 3)):
        memory.add(smooth_frame(number), ANGLES, made_at)
    asked = []

    def target_of(image, elevation):
        asked.append(image)
        assert elevation.shape == ANGLES.shape
        return np.full(SHAPE, 0.25, np.float16)

    before = memory.nbytes
    memory.renew(6, target_of)
    found = [unpack(packed) for packed in memory.sample(3)]
    for number, frame in enumerate(found):
        assert (frame.target == 0.25).all() == (number == 1)
        assert np.array_equal(frame.valid_mask, smooth_frame(number).valid_mask)
    assert memory.nbytes < before  # a flat target packs better
    assert memory.nbytes == sum(packed.nbytes for packed in memory.sample(3))
    for now in (6, 6, 6):
        memory.renew(now, target_of)
    assert len(asked) == 3  # each once: then all are of now


def test_a_renewed_target_that_packs_worse_keeps_the_bound():
    memory = ReplayBuffer(10, np.random.default_rng(0))
    flat = replace(smooth_frame(0), target=np.zeros(SHAPE, np.float16))
    for _ in range(3):
        memory.add(flat, ANGLES, 0)
    memory._limit_bytes = memory.nbytes
    memory.renew(1, lambda image, elevation: smooth_frame(1).target)
    assert memory.nbytes <= memory._limit_bytes
    assert len(memory) == 2


def test_packing_keeps_target_mask_and_nearly_the_image():
    frame = smooth_frame(0)
    frame.target[:] *= np.float16(1e-3)  # a sure floor is no certain floor
    found = unpack(pack(frame, ANGLES))
    assert np.array_equal(found.valid_mask, frame.valid_mask)
    assert np.array_equal(found.target, frame.target)
    assert np.abs(found.image.astype(int) - frame.image).mean() < 1.5
    assert found.target.dtype == np.float16


@pytest.mark.real_data
@pytest.mark.parametrize("name", ["arena", "corridor", "hallway", "kitti"])
def test_frames_take_a_fifth_of_their_room_or_less(data_dir, name):
    recording = open_recording(data_dir / name)
    store = FrameStore(recording, Config())
    view = next(store.views([recording.length // 2]))
    frame = half_resolution_frame(view, store.config, None)
    packed = pack(frame, halved(view.elevation))
    assert packed.nbytes < frame.nbytes / 5
    assert np.array_equal(unpack(packed).target, frame.target)
    assert np.abs(unpack(packed).image.astype(int) - frame.image).mean() < 2.0


@settings(max_examples=20, deadline=None)
@given(st.floats(0.004, 0.05), st.integers(1, 40))
def test_the_memory_is_bounded(memory_mb, count):
    memory = ReplayBuffer(memory_mb, np.random.default_rng(0))
    for seed in range(count):
        memory.add(smooth_frame(seed), ANGLES, 0)
        assert memory.nbytes <= memory_mb * 2**20 or len(memory) == 1
        assert memory.nbytes == sum(packed.nbytes for packed in memory.sample(100))
    assert len(memory) >= 1
    assert memory.seen == count


def test_one_frame_is_kept_however_small_the_memory():
    memory = ReplayBuffer(1e-6, np.random.default_rng(0))
    for seed in range(3):
        memory.add(smooth_frame(seed), ANGLES, 0)
    assert len(memory.draw(4)) == 4


def test_a_changing_stream_is_remembered_evenly():
    frames = [smooth_frame(seed) for seed in range(60)]
    kept = np.zeros(60)
    for seed in range(60):
        memory = ReplayBuffer(10.5 * pack(frames[0], ANGLES).nbytes / 2**20, np.random.default_rng(seed))
        for frame in frames:
            memory.add(frame, ANGLES, 0)
        kept[memory.numbers()] += 1
    # About 10 of 60 stay: each frame 10 times of 60, standard deviation 2.9; half the frames 300, +- 16.
    assert 500 < kept.sum() < 660
    assert abs(kept[:30].sum() - kept[30:].sum()) < 80
    assert kept.max() < 25


def test_a_long_halt_does_not_push_out_what_was_before():
    moving, halt = [smooth_frame(seed) for seed in range(40)], smooth_frame(40)
    memory = ReplayBuffer(20 * pack(halt, ANGLES).nbytes / 2**20, np.random.default_rng(0))
    for frame in [*moving, *[halt] * 400]:
        memory.add(frame, ANGLES, 0)
    before = sum(number < 40 for number in memory.numbers())
    # Evenly it would be 40 of 440, two of the twenty.
    assert before >= 8


def test_a_restored_memory_goes_on_the_same_way(tmp_path):
    frames = [smooth_frame(seed) for seed in range(50)]
    whole_rng = np.random.default_rng(0)
    whole = ReplayBuffer(0.03, whole_rng)
    for frame in frames[:25]:
        whole.add(frame, ANGLES, 0)
    write_checkpoint(tmp_path / "c", Snapshot.join({"m": whole.snapshot()}))
    rng = np.random.default_rng(99)
    rng.bit_generator.state = whole_rng.bit_generator.state
    restored = ReplayBuffer(0.03, rng)
    restored.restore(read_checkpoint(tmp_path / "c").part("m"))
    for frame in frames[25:]:
        whole.add(frame, ANGLES, 0)
        restored.add(frame, ANGLES, 0)
    assert whole.numbers() == restored.numbers()
    assert whole.nbytes == restored.nbytes
    for one, other in zip(whole.draw(5), restored.draw(5), strict=True):
        assert np.array_equal(one.image, other.image)
        assert np.array_equal(one.target, other.target)


def test_an_empty_memory_comes_back(tmp_path):
    memory = ReplayBuffer(1, np.random.default_rng(0))
    write_checkpoint(tmp_path / "c", Snapshot.join({"m": memory.snapshot()}))
    memory.restore(read_checkpoint(tmp_path / "c").part("m"))
    assert len(memory) == 0
    memory.add(smooth_frame(1), ANGLES, 0)
    assert len(memory.draw(3)) == 3
