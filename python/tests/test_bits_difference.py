"""The first bit in which two recordings differ."""

import numpy as np
import pytest

from libration import first_difference


def test_the_same_recording_has_no_difference():
    a = np.random.default_rng(0).normal(size=(5, 4, 3))
    assert first_difference(a, a.copy()) is None
    assert first_difference(a[:, ::2], np.ascontiguousarray(a[:, ::2])) is None
    assert first_difference([1.0, 2.0], [1.0, 2.0]) is None and first_difference(1.5, 1.5) is None
    assert first_difference(np.empty((0, 3)), np.empty((0, 3))) is None


def test_the_first_difference_has_its_step_environment_and_component():
    a = np.random.default_rng(0).normal(size=(50, 8, 3))
    b = a.copy()
    b[20, 5, 1] = np.nextafter(b[20, 5, 1], np.inf)
    b[31:] += 1.0
    found = first_difference(a, b)
    assert found.index == (20, 5, 1) and found.ulps == 1 and found.differing == 1 + 19 * 8 * 3
    assert (found.a, found.b) == (a[20, 5, 1], b[20, 5, 1])


def test_zeros_of_different_sign_differ_and_nan_has_no_ulps():
    found = first_difference([0.0], [-0.0])
    assert found.index == (0,) and found.ulps == 0
    assert first_difference([np.nan], [1.0]).ulps is None
    assert first_difference([np.nan], [np.nan]) is None


def test_single_precision_and_integers_are_compared_as_they_are():
    a = np.array([1.0, 2.0], dtype=np.float32)
    b = a.copy()
    b[1] = np.nextafter(b[1], np.float32(3))
    assert first_difference(a, b).ulps == 1
    assert first_difference(np.float32([1e-45]), np.float32([-1e-45])).ulps == 2
    assert first_difference([1, 2], [1, 3]).index == (1,) and first_difference([True], [False]).a == 1.0


def test_large_integers_that_are_no_floats_differ():
    a = np.array([0, 2**53], dtype=np.int64)
    found = first_difference(a, a + np.array([0, 1]))
    assert found is not None and found.index == (1,) and found.differing == 1
    assert (found.a, found.b, found.ulps) == (2**53, 2**53 + 1, None)


def test_files_are_recordings(tmp_path):
    a = np.arange(6.0).reshape(2, 3)
    np.save(tmp_path / "a.npy", a)
    np.save(tmp_path / "b.npy", a + np.eye(2, 3))
    assert first_difference(tmp_path / "a.npy", str(tmp_path / "b.npy")).index == (0, 0)


def test_files_of_several_arrays_are_compared_in_the_order_of_the_first(tmp_path):
    a = {"states": np.arange(6.0).reshape(2, 3), "actions": np.ones(4, dtype=np.float32), "done": np.zeros(3, dtype=bool)}
    b = {name: array.copy() for name, array in reversed(a.items())}
    np.savez(tmp_path / "a.npz", **a)
    np.savez_compressed(tmp_path / "b.npz", **b)
    assert first_difference(tmp_path / "a.npz", tmp_path / "b.npz") is None
    b["done"][1] = True
    b["actions"][2:] = np.nextafter(np.float32(1), np.float32(2))
    np.savez(tmp_path / "b.npz", **b)
    found = first_difference(str(tmp_path / "a.npz"), tmp_path / "b.npz")
    assert (found.array, found.index, found.ulps, found.differing) == ("actions", (2,), 1, 3)
    assert first_difference(tmp_path / "b.npz", tmp_path / "a.npz").array == "done"
    # An array alone has no name.
    assert first_difference(a["actions"], b["actions"]).array is None


def test_files_that_are_not_comparable_are_errors(tmp_path):
    def file(name, **arrays):
        np.savez(tmp_path / name, **arrays)
        return tmp_path / name

    a = file("a.npz", x=np.ones(2), y=np.ones(2))
    np.save(tmp_path / "one.npy", np.ones(2))
    np.save(tmp_path / "object.npy", np.array([None]))
    (tmp_path / "empty.npy").write_bytes(b"")
    (tmp_path / "text.npz").write_text("x,y")
    (tmp_path / "cut.npz").write_bytes(a.read_bytes()[:300])
    spoiled = bytearray(a.read_bytes())
    spoiled[150] ^= 255
    (tmp_path / "spoiled.npz").write_bytes(spoiled)
    for b, error, message in (
        (file("b.npz", x=np.ones(2), z=np.ones(2)), ValueError, "different names: only a has y; only b has z; expected the same names"),
        (file("c.npz", x=np.ones(2)), ValueError, "different names: only a has y; expected"),
        (file("d.npz", x=np.ones(2), y=np.ones(3)), ValueError, r"a\['y'\] is float64 of shape \(2,\) and b\['y'\] float64 of shape \(3,\)"),
        (file("e.npz", x=np.ones(2), y=np.array(["t"])), TypeError, r"b\['y'\] has type <U1; expected float64"),
        (file("f.npz", x=np.ones(2), y=np.array([None])), ValueError, "b cannot be read: Object arrays cannot be loaded"),
        (tmp_path / "one.npy", ValueError, "a is a file .npz and b a single array; expected two files .npz, or one of the arrays of a"),
        *(
            (tmp_path / name, ValueError, "b cannot be read: .*; expected a file .npy or .npz of numbers")
            for name in ("object.npy", "empty.npy", "text.npz", "cut.npz", "spoiled.npz", "missing.npz")
        ),
    ):
        with pytest.raises(error, match=message):
            first_difference(a, b)


@pytest.mark.parametrize(
    ("a", "b", "error", "message"),
    [
        ([1.0], [1.0, 2.0], ValueError, r"a is float64 of shape \(1,\) and b float64 of shape \(2,\); expected the same shape and type"),
        (np.float32([1]), [1.0], ValueError, "a is float32 .* expected the same shape and type"),
        ([1j], [1j], TypeError, "a has type complex128; expected float64"),
        (np.float16([1]), np.float16([1]), TypeError, "a has type float16; expected"),
        (["x"], ["x"], TypeError, "a has type <U1; expected"),
        ([None], [None], TypeError, "a has type object; expected"),
        ("missing.npy", [1.0], ValueError, "a cannot be read: .*; expected a file .npy"),
    ],
)
def test_an_error_names_the_value_and_what_is_allowed(a, b, error, message):
    with pytest.raises(error, match=message):
        first_difference(a, b)
