import pytest
from hypothesis import given
from hypothesis import strategies as st

from horizon_dl.evaluation.protocols import split_frames


def test_labelled_out_takes_every_tenth_where_all_are_labelled():
    split = split_frames("labelled-out", [True] * 30)
    assert split.test == [5, 15, 25]
    assert split.train == [i for i in range(30) if i not in {4, 5, 6, 14, 15, 16, 24, 25, 26}]


def test_labelled_out_takes_the_labelled_frames():
    labelled = [i in (0, 7) for i in range(10)]
    split = split_frames("labelled-out", labelled)
    assert split.test == [0, 7]
    assert split.train == [2, 3, 4, 5, 9]


def test_tail_keeps_the_order():
    split = split_frames("tail", [True] * 20)
    assert split.train == list(range(18))
    assert split.test == [18, 19]


def test_tail_tests_only_what_has_truth():
    assert split_frames("tail", [i == 19 for i in range(20)]).test == [19]
    assert split_frames("tail", [i == 0 for i in range(20)]).test == []


def test_prequential_tests_after_the_first_twenty():
    split = split_frames("prequential", [True] * 25)
    assert split.train == list(range(25))
    assert split.test == [20, 21, 22, 23, 24]


def test_without_truth_it_splits_as_if_all_had_one():
    assert split_frames("labelled-out", [False] * 30) == split_frames("labelled-out", [True] * 30)


@given(st.lists(st.booleans(), max_size=60), st.sampled_from(["tail", "labelled-out"]))
def test_no_frame_is_both_trained_on_and_tested(labelled, protocol):
    split = split_frames(protocol, labelled)
    assert not set(split.train) & set(split.test)
    assert split.train == sorted(split.train)
    if protocol == "labelled-out":
        assert all(abs(a - b) > 1 for a in split.train for b in split.test)


@pytest.mark.parametrize("count", [0, 1, 2])
def test_tiny_sets_do_not_fail(count):
    for protocol in ("tail", "labelled-out", "prequential"):
        split_frames(protocol, [True] * count)
