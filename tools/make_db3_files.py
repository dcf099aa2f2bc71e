"""Writes the ROS 2 bags in SQLite that the tests of libration-logs read, with the module sqlite3 of Python.

    python tools/make_db3_files.py crates/libration-logs/tests/data

The tables are those of rosbag2: of version 3 of the schema (Humble), and of version 4 (Iron), which has definitions of messages.
Messages are CDR, little-endian. Message i of /joint_states has the log time 1_700_000_000 s + 10 ms · i + 1 µs · (i² mod 7), the header
stamp 1 ms earlier, and the positions i + j / 4.
"""

import pathlib
import sqlite3
import struct
import sys

FOLDER = pathlib.Path(sys.argv[1])
START = 1_700_000_000_000_000_000
MESSAGES = 40

TABLES = """
CREATE TABLE schema(schema_version INTEGER PRIMARY KEY, ros_distro TEXT NOT NULL);
CREATE TABLE metadata(id INTEGER PRIMARY KEY, metadata_version INTEGER NOT NULL, metadata TEXT NOT NULL);
CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL,
                    serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL);
CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER NOT NULL, data BLOB NOT NULL);
CREATE INDEX timestamp_idx ON messages (timestamp ASC);
"""

DEFINITIONS = """
CREATE TABLE message_definitions(id INTEGER PRIMARY KEY, topic_type TEXT NOT NULL, encoding TEXT NOT NULL,
                                 encoded_message_definition TEXT NOT NULL, type_description_hash TEXT NOT NULL);
"""


class Cdr:
    """Bytes of a message; numbers are aligned to their size behind the encapsulation."""

    def __init__(self):
        self.body = b""

    def number(self, code, value):
        size = struct.calcsize(code)
        self.body += b"\0" * (-len(self.body) % size) + struct.pack("<" + code, value)
        return self

    def text(self, value):
        self.number("I", len(value) + 1)
        self.body += value.encode() + b"\0"
        return self

    def header(self, time, frame):
        return self.number("i", time // 10**9).number("I", time % 10**9).text(frame)

    def floats(self, values):
        self.number("I", len(values))
        for value in values:
            self.number("d", value)
        return self

    def data(self):
        return b"\0\1\0\0" + self.body


def joint_state(i, time):
    message = Cdr().header(time, "base")
    message.number("I", 2).text("left").text("right")
    return message.floats([i + j / 4 for j in range(2)]).floats([-i, i]).floats([]).data()


def image(i, time):
    message = Cdr().header(time, "camera").number("I", 60).number("I", 40).text("rgb8").number("B", 0).number("I", 120)
    message.number("I", 5000)
    message.body += bytes([i]) * 5000
    return message.data()


def array(i):
    """Of 8 bytes for each of 126 to 130 numbers: only the least part of the record stays on its first page."""
    return Cdr().number("I", 0).number("I", 0).floats([k + i / 4 for k in range(126 + 2 * i)]).data()


def load(i, time):
    return Cdr().header(time, "").number("f", i / 2).data()


def write(name, version, distro, topics, messages):
    path = FOLDER / name
    path.unlink(missing_ok=True)
    bag = sqlite3.connect(path)
    # Small pages for a small file with a tree of several levels.
    bag.execute("PRAGMA page_size = 1024")
    bag.executescript(TABLES)
    bag.execute("INSERT INTO schema VALUES (?, ?)", (version, distro))
    for topic in topics:
        bag.execute("INSERT INTO topics(name, type, serialization_format, offered_qos_profiles) VALUES (?, ?, 'cdr', '')", topic)
    if version > 3:
        bag.executescript(DEFINITIONS)
        text = "std_msgs/Header header\nfloat32 newtons\n"
        bag.execute(
            "INSERT INTO message_definitions(topic_type, encoding, encoded_message_definition, type_description_hash) VALUES (?, 'ros2msg', ?, '')",
            ("my_msgs/msg/Load", text),
        )
    bag.executemany("INSERT INTO messages(topic_id, timestamp, data) VALUES (?, ?, ?)", messages)
    bag.commit()
    bag.close()


def times(i):
    log = START + 10_000_000 * i + 1000 * (i * i % 7)
    return log, log - 1_000_000


rows = []
for i in range(MESSAGES):
    log, stamp = times(i)
    rows.append((1, log, joint_state(i, stamp)))
    rows.append((2, log + 2_000_000, load(i, stamp)))
    if i < 3:
        rows.append((4, log + 2000, array(i)))
    if i % 20 == 3:
        rows.append((3, log + 1000, image(i, stamp)))
write(
    "humble.db3",
    3,
    "humble",
    [
        ("/joint_states", "sensor_msgs/msg/JointState"),
        ("/load", "my_msgs/msg/Load"),
        ("/camera", "sensor_msgs/msg/Image"),
        ("/array", "std_msgs/msg/Float64MultiArray"),
    ],
    rows,
)
write("iron.db3", 4, "iron", [("/load", "my_msgs/msg/Load")], [(1, times(i)[0], load(i, times(i)[1])) for i in range(5)])


def write_small(name, messages, rows):
    """A bag with one topic and this table of messages."""
    path = FOLDER / name
    path.unlink(missing_ok=True)
    bag = sqlite3.connect(path)
    bag.execute("PRAGMA page_size = 512")
    bag.execute("CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT, serialization_format TEXT)")
    bag.execute("INSERT INTO topics(name, type, serialization_format) VALUES ('/load', 'std_msgs/msg/Float64', 'cdr')")
    bag.execute(messages)
    bag.executemany("INSERT INTO messages(id, topic_id, timestamp, data) VALUES (?, ?, ?, ?)", rows)
    bag.commit()
    bag.close()


small = [(i + 1, 1, START + 10_000_000 * i, Cdr().number("d", i / 2).data()) for i in range(3)]
usual = "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, data BLOB)"
write_small("empty.db3", usual, [])
write_small("without_rowid.db3", usual + " WITHOUT ROWID", small)
write_small("text_stamps.db3", usual.replace("timestamp INTEGER", "timestamp TEXT"), small)
commented = usual.replace("topic_id", "-- the id, of (a topic\n topic_id").replace("timestamp INTEGER", "/* a, b */ timestamp INTEGER DEFAULT (1 + 2)")
write_small("commented.db3", commented, small)
