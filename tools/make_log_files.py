"""Writes the logs that the tests of libration-logs read, with mcap 1.6.0, mcap-ros2-support 0.6.0, rosbags 0.11.9, pyulog 1.3.0,
pyarrow 26.0.1 and NumPy 2.4.6.

    python tools/make_log_files.py crates/libration-logs/tests/data
"""

import json
import pathlib
import random
import struct
import sys

import mcap.writer
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from mcap.well_known import MessageEncoding, SchemaEncoding
from mcap_ros2.reader import read_ros2_messages
from mcap_ros2.writer import Writer as RosWriter
from pyulog import ULog
from rosbags.rosbag1 import Writer as Writer1
from rosbags.typesys import Stores, get_typestore

FOLDER = pathlib.Path(sys.argv[1])
FOLDER.mkdir(parents=True, exist_ok=True)

HEADER = """
================================================================================
MSG: std_msgs/Header
# Standard metadata for higher-level stamped data types.
builtin_interfaces/Time stamp
string frame_id
================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
"""

JOINT_STATE = """# The state of a set of torque controlled joints.
std_msgs/Header header

string[] name
float64[] position
float64[] velocity
float64[] effort
""" + HEADER

TWIST_STAMPED = """# A twist with reference coordinate frame and timestamp
std_msgs/Header  header
Twist  twist
================================================================================
MSG: geometry_msgs/Twist
Vector3  linear
Vector3  angular
================================================================================
MSG: geometry_msgs/Vector3
float64 x
float64 y
float64 z
""" + HEADER

STATISTICS = """uint8 OK=0
string NAME = "a # b"
builtin_interfaces/Time stamp
bool active true
string note
int8[3] small
uint16[<=4] some
Pair[2] pairs
float32 last
================================================================================
MSG: test_msgs/Pair
uint8 a
int64 b
================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
"""

START = 1_700_000_000_123_456_789
PERIOD = 10_000_000


def ros_bag(path, compression, count):
    """Joint states at 100 Hz and commands with the same header stamps; the log clock is 50 ppm fast, and some stamps go back."""
    noise = random.Random(1)
    with open(path, "wb") as file:
        writer = RosWriter(file, chunk_size=4096, compression=compression)
        joint = writer.register_msgdef("sensor_msgs/msg/JointState", JOINT_STATE)
        twist = writer.register_msgdef("geometry_msgs/msg/TwistStamped", TWIST_STAMPED)
        statistics = writer.register_msgdef("test_msgs/msg/Statistics", STATISTICS)
        for k in range(count):
            stamp = START + k * PERIOD + noise.randrange(200_000)
            header = {"stamp": {"sec": stamp // 10**9, "nanosec": stamp % 10**9}, "frame_id": "base"}
            log = START + 1_000_000 + round((stamp - START) * (1 + 50e-6)) + noise.randrange(500_000)
            # Two messages are logged before their predecessors.
            log -= 15_000_000 if k in (20, 30) else 0
            writer.write_message(
                "/joint_states",
                joint,
                {
                    "header": header,
                    "name": ["a", "bc", "def", "ghij"],
                    "position": [0.1 * k, 1.0, 2.0, float(k)],
                    "velocity": [0.0] * 4,
                    "effort": [],
                },
                log_time=log,
                publish_time=log - 100_000,
                sequence=k,
            )
            if k % 10 != 9:
                writer.write_message(
                    "/cmd",
                    twist,
                    {
                        "header": header,
                        "twist": {"linear": {"x": k / 2, "y": 0.0, "z": 0.0}, "angular": {"x": 0.0, "y": 0.0, "z": -1.0}},
                    },
                    log_time=log + 3_000_000 + noise.randrange(2_000_000),
                    publish_time=log + 3_000_000,
                    sequence=k,
                )
            if k % 10 == 0:
                writer.write_message(
                    "/statistics",
                    statistics,
                    {
                        "stamp": header["stamp"],
                        "active": True,
                        "note": "w",
                        "small": [-1, 2, -3],
                        "some": [7, 8],
                        "pairs": [{"a": 1, "b": -5}, {"a": 2, "b": 2**40}],
                        "last": 0.5,
                    },
                    log_time=log,
                    publish_time=log,
                    sequence=k,
                )
        writer.finish()


def json_bag(path):
    with open(path, "wb") as file:
        writer = mcap.writer.Writer(file, use_chunking=False)
        writer.start(profile="", library="test")
        schema = writer.register_schema("Pose", SchemaEncoding.JSONSchema, json.dumps({"type": "object"}).encode())
        channel = writer.register_channel("/pose", MessageEncoding.JSON, schema)
        for k in range(10):
            message = {"x": k / 4, "name": "n", "list": [k, {"y": -k}], "ok": k % 2 == 0}
            writer.add_message(channel, START + k * PERIOD, json.dumps(message).encode(), START + k * PERIOD)
        writer.finish()


def tables():
    stamps = START + np.arange(50, dtype=np.int64) * 1_000_003
    x = np.sin(np.arange(50) * 0.1)
    np.savez(FOLDER / "table.npz", stamp=stamps, x=x, pair=np.stack([x, 2 * x], 1))
    np.save(FOLDER / "matrix.npy", np.stack([np.arange(50) * 0.01, x], 1))
    records = np.zeros(20, dtype=[("step", "<u8"), ("t", "<f8"), ("x", "<f4", (2,)), ("s", "<U3")])
    records["t"] = np.arange(20) * 0.25
    records["x"][:, 1] = np.arange(20)
    np.save(FOLDER / "records.npy", records)
    holes = [None if k % 7 == 0 else float(v) for k, v in enumerate(x)]
    table = {
        "x": pa.array(holes),
        "stamp": pa.array(stamps, pa.timestamp("ns")),
        "n": pa.array(np.arange(50, dtype=np.uint32)),
        "s": ["a"] * 50,
    }
    pq.write_table(pa.table(table), FOLDER / "table.parquet", compression="zstd")
    ticks = np.arange(20, dtype=np.int64) * 2500
    table = {unit: pa.array(ticks, pa.duration(unit)) for unit in ("s", "ms", "us", "ns")}
    pq.write_table(pa.table({"x": pa.array(x[:20]), **table}), FOLDER / "durations.parquet", compression="zstd")


def expected(name):
    """What the packages read from a bag: log time, publish time, header stamp in ns, and the last position or the angular rate."""
    rows = {}
    with open(FOLDER / name, "rb") as file:
        for message in read_ros2_messages(file, log_time_order=False):
            own = message.ros_msg
            stamp = own.header.stamp if hasattr(own, "header") else own.stamp
            value = own.position[3] if hasattr(own, "position") else own.twist.angular.z if hasattr(own, "twist") else own.pairs[1].b
            row = [message.log_time_ns, message.publish_time_ns, stamp.sec * 10**9 + stamp.nanosec, value]
            rows.setdefault(message.channel.topic, []).append(row)
    (FOLDER / name).with_suffix(".json").write_text(json.dumps(rows) + "\n")


def rosbag1(path, compression):
    """Joint states of ROS 1 at 50 Hz."""
    store = get_typestore(Stores.ROS1_NOETIC)
    kind = store.types["sensor_msgs/msg/JointState"]
    header, time = store.types["std_msgs/msg/Header"], store.types["builtin_interfaces/msg/Time"]
    path.unlink(missing_ok=True)
    writer = Writer1(path)
    if compression:
        writer.set_compression(compression)
    with writer:
        connection = writer.add_connection("/joint_states", kind.__msgtype__, typestore=store)
        for k in range(40):
            stamp = START + 20_000_000 * k
            own = header(k, time(stamp // 10**9, stamp % 10**9), "base")
            empty = np.zeros(0)
            message = kind(own, ["a", "bc"], np.array([0.5 * k, -1.0]), empty, empty)
            writer.write(connection, stamp + 1000 * k, store.serialize_ros1(message, kind.__msgtype__))


def ulog(path):
    """A log as PX4 writes it; pyulog, which cannot write new files, reads it for comparison."""
    out = bytearray(b"ULog\x01\x12\x35\x01" + struct.pack("<Q", 1000))

    def message(letter, body):
        out.extend(struct.pack("<HB", len(body), ord(letter)) + body)

    message("B", bytes(40))
    message("F", b"vehicle_imu:uint64_t timestamp;uint64_t timestamp_sample;float[3] gyro;uint8_t flag;uint8_t[3] _padding0;pair p;")
    message("F", b"pair:int16_t a;uint8_t[6] _padding0;double b;")
    message("F", b"rate:uint64_t timestamp;float x;")
    for ident, instance, name in [(0, 0, b"vehicle_imu"), (1, 1, b"vehicle_imu"), (2, 0, b"rate")]:
        message("A", struct.pack("<BH", instance, ident) + name)
    for k in range(40):
        now = 5_000_000 + 4000 * k + (k * 37) % 100
        for ident in (0, 1):
            body = struct.pack("<HQQfffB3xh6xd", ident, now + ident, now - 300, 0.5 * k, 1.0, -2.0, 7, -k, 1e-3 * k)
            message("D", body)
        if k % 4 == 0:
            message("D", struct.pack("<HQf", 2, now + 50, k))
    message("O", struct.pack("<H", 12))
    path.write_bytes(out)
    read = ULog(str(path))
    rows = {}
    for data in read.data_list:
        name = data.name if data.multi_id == 0 else f"{data.name}/{data.multi_id}"
        rows[name] = {key: [float(x) for x in values] for key, values in data.data.items() if "padding" not in key}
    path.with_suffix(".json").write_text(json.dumps(rows) + "\n")


rosbag1(FOLDER / "ros1.bag", None)
rosbag1(FOLDER / "ros1_lz4.bag", Writer1.CompressionFormat.LZ4)
rosbag1(FOLDER / "ros1_bz2.bag", Writer1.CompressionFormat.BZ2)
ulog(FOLDER / "px4.ulg")
ros_bag(FOLDER / "zstd.mcap", mcap.writer.CompressionType.ZSTD, 160)
ros_bag(FOLDER / "lz4.mcap", mcap.writer.CompressionType.LZ4, 60)
ros_bag(FOLDER / "none.mcap", mcap.writer.CompressionType.NONE, 30)
whole = (FOLDER / "zstd.mcap").read_bytes()
(FOLDER / "truncated.mcap").write_bytes(whole[: len(whole) * 2 // 5])
json_bag(FOLDER / "json.mcap")
expected("lz4.mcap")
expected("none.mcap")
tables()
