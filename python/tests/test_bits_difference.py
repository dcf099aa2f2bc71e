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
