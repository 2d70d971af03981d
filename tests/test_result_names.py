import os

from hypothesis import given, settings
from hypothesis import strategies as st

from horizon_dl.output.names import ResultNames, inside


def test_names_are_short_where_that_is_enough():
    names = [f"images/{number:03d}.png" for number in range(3)]
    assert [ResultNames(names)(name) for name in names] == ["000", "001", "002"]


def test_equal_stems_keep_apart():
    names = ["a/1.png", "b/1.png", "b/1.jpg", "2.png"]
    given_names = ResultNames(names)
    assert [given_names(name) for name in names] == ["a/1", "b/1.png", "b/1.jpg", "2"]
    unknown = ResultNames()
    assert [unknown(name) for name in ["a/1.png", "b/1.png", "a/1.png"]] == ["1", "b/1.png", "a/1.png"]


def test_no_name_leaves_the_folder():
    for name in ("../../etc/passwd", "/etc/passwd", "a/../../b", "..", "", "/"):
        assert not inside(name).is_absolute()
        assert ".." not in inside(name).parts
    assert len(os.fsencode(inside("x" * 300 + ".png").name)) < 200


@settings(deadline=None)
@given(st.lists(st.text(st.sampled_from("ab1./-"), max_size=8), max_size=12))
def test_every_frame_has_a_name_of_its_own(names):
    for known in (names, ()):
        give = ResultNames(known)
        found = [give(name) for name in names]
        assert len(set(found)) == len(found)
        assert all(not name.startswith("/") and ".." not in name.split("/") for name in found)
