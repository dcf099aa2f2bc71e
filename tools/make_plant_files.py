"""Writes the files of arrays of `crates/libration-data/tests/array_file`, with NumPy 2.4.6 and SciPy 1.17.1.

    python tools/make_plant_files.py FOLDER
"""

import pathlib
import struct
import sys
import zipfile

import numpy as np
from scipy.io import loadmat, savemat
from scipy.sparse import csc_array

folder = pathlib.Path(sys.argv[1])
A = np.array([[0.0, 1.0], [-2.5, -0.125]])
B = np.array([[0.0], [4.0]])
C = np.array([[1.0, 0.0], [0.0, 1.0], [1.0, 1.0]])
D = np.zeros((3, 1))
plant = {"A": A, "B": B, "C": C, "D": D}

np.savez(folder / "stored.npz", **plant, dt=0.01)
np.savez_compressed(folder / "deflated.npz", **plant, dt=0.01)
np.savez(
    folder / "types.npz",
    A=np.asfortranarray(A.astype(">f4")),
    B=B.ravel().astype("<i4"),
    C=np.asfortranarray(C.astype(">i8")),
    G=np.uint8([[0], [3]]),
    states=np.array(["angle (rad)", "ω (rad/s)"]),
)
np.savez_compressed(folder / "mechanical.npz", mass=np.diag([1.0, 2.0]), stiffness=[[3, -1], [-1, 1]], b=[1, 0])
np.savez(folder / "complex.npz", A=A + 1j)
np.savez(folder / "object.npz", dt=np.array(None))
with zipfile.ZipFile(folder / "versions.npz", "w") as archive:
    for name, version in [("A", (2, 0)), ("B", (3, 0))]:
        with archive.open(f"{name}.npy", "w") as file:
            np.lib.format.write_array(file, plant[name], version=version)

savemat(folder / "v5.mat", {**plant, "Ts": 0.01})
savemat(folder / "v7.mat", {**plant, "Ts": 0.01}, do_compression=True)
savemat(folder / "types.mat", {"A": A.astype("f4"), "B": np.int8(B), "C": np.uint16(C), "D": np.int64(D - 1)})
savemat(folder / "sparse.mat", {"A": csc_array(A)})
savemat(folder / "complex.mat", {"A": A + 1j})
savemat(folder / "structure.mat", {"plant": {"A": A}})


def packed_file(path, order):
    """MATLAB stores the integers of a double array in bytes: class 6 (double), numbers of type 2 (uint8). SciPy does not."""
    bytes_of_a = A_INTEGERS.astype(np.uint8).tobytes(order="F")
    content = struct.pack(f"{order}IIII", 6, 8, 6, 0)
    content += struct.pack(f"{order}IIii", 5, 8, *A_INTEGERS.shape)
    content += struct.pack(f"{order}I4s", 1 << 16 | 1, b"A")
    content += struct.pack(f"{order}II", 2, len(bytes_of_a)) + bytes_of_a.ljust(8, b"\0")
    header = b"MATLAB 5.0 MAT-file".ljust(124) + struct.pack(f"{order}HH", 0x100, 0x4D49)
    path.write_bytes(header + struct.pack(f"{order}II", 14, len(content)) + content)
    read = loadmat(path, mat_dtype=True)["A"]
    assert read.dtype.kind == "f" and (read == A_INTEGERS).all()


A_INTEGERS = np.array([[0, 1, 2], [7, 200, 255]])
packed_file(folder / "packed_little.mat", "<")
packed_file(folder / "packed_big.mat", ">")
