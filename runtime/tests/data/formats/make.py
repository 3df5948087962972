"""Writes the recordings beside this file with the official Python packages:

    pip install mcap mcap-ros2-support pyarrow && python make.py

Two joints, `elbow` and `shoulder`, at 100 Hz from the epoch 1,700,000,000 s on. Row k holds, exactly:
q = k/128, -k/256; dq = k/64, -k/32; torque = 1 + k/16, 2 - k/8.
"""

import pathlib
import shutil
import struct

import pyarrow as pa
import pyarrow.parquet as pq
from mcap.writer import CompressionType, IndexType, Writer
from mcap_ros2._dynamic import serialize_dynamic

HERE = pathlib.Path(__file__).parent
ROWS = 40
EPOCH = 1_700_000_000
STEP = 10_000_000
HEADER = """
================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
"""
JOINT_STATE = "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] effort" + HEADER
DYNAMIC = (
    "std_msgs/Header header\nstring[] joint_names\ncontrol_msgs/InterfaceValue[] interface_values"
    + HEADER
    + "=" * 80
    + "\nMSG: control_msgs/InterfaceValue\nstring[] interface_names\nfloat64[] values\n"
)
POINT = "float64[] positions\nfloat64[] velocities\nfloat64[] accelerations\nfloat64[] effort\nbuiltin_interfaces/Duration time_from_start\n"
CONTROLLER = (
    "std_msgs/Header header\nstring[] joint_names\ntrajectory_msgs/JointTrajectoryPoint desired\n"
    "trajectory_msgs/JointTrajectoryPoint actual\ntrajectory_msgs/JointTrajectoryPoint error  # desired - actual\n"
    "string multi_dof_joint_names\nuint8 OK=1\nuint8[3] flags\nfloat32 load"
    + HEADER
    + "=" * 80
    + "\nMSG: trajectory_msgs/JointTrajectoryPoint\n"
    + POINT
    + "=" * 80
    + "\nMSG: builtin_interfaces/Duration\nint32 sec\nuint32 nanosec\n"
)
CONTROLLER_TYPE = "control_msgs/msg/JointTrajectoryControllerState"
encode_controller = serialize_dynamic(CONTROLLER_TYPE, CONTROLLER)[CONTROLLER_TYPE]
TYPE = "sensor_msgs/msg/JointState"
encode = serialize_dynamic(TYPE, JOINT_STATE)[TYPE]
DYNAMIC_TYPE = "control_msgs/msg/DynamicJointState"
encode_dynamic = serialize_dynamic(DYNAMIC_TYPE, DYNAMIC)[DYNAMIC_TYPE]


def row(k):
    return [k / 128, -k / 256], [k / 64, -k / 32], [1 + k / 16, 2 - k / 8]


def header(k, frame="base"):
    return dict(stamp=dict(sec=EPOCH + k * STEP // 10**9, nanosec=k * STEP % 10**9), frame_id=frame)


def state(k, joints=(0, 1), velocity=True, effort=True, frame="base", names=("elbow", "shoulder")):
    q, dq, u = row(k)
    pick = lambda values: [values[j] for j in joints]
    return dict(
        header=header(k, frame),
        name=[names[j] for j in joints],
        position=pick(q),
        velocity=pick(dq) if velocity else [],
        effort=pick(u) if effort else [],
    )


def gripper(k):
    return dict(header=header(k), name=["finger"], position=[0.5], velocity=[0.0], effort=[9.0])


def big_endian(k):
    q, dq, u = row(k)
    out = bytearray(struct.pack(">iI", EPOCH + k * STEP // 10**9, k * STEP % 10**9))

    def align(n):
        out.extend(b"\0" * (-len(out) % n))

    def text(value):
        align(4)
        out.extend(struct.pack(">I", len(value) + 1) + value.encode() + b"\0")

    text("base")
    align(4)
    out.extend(struct.pack(">I", 2))
    text("elbow")
    text("shoulder")
    for values in (q, dq, u):
        align(4)
        out.extend(struct.pack(">I", len(values)))
        align(8)
        out.extend(struct.pack(f">{len(values)}d", *values))
    return b"\0\0\0\0" + bytes(out)


def write(name, messages, *, topic="/joint_states", kind=TYPE, text=JOINT_STATE, encoding="cdr", **options):
    """`messages`: of each its row, its bytes and, if it is not `topic`, its topic."""
    options.setdefault("compression", CompressionType.NONE)
    options.setdefault("chunk_size", 2048)
    with open(HERE / name, "wb") as file:
        writer = Writer(file, **options)
        writer.start(profile="ros2", library="make.py")
        schema = writer.register_schema(kind, "ros2msg", text.encode())
        channels = {}
        for k, data, *other in messages:
            where = other[0] if other else topic
            if where not in channels:
                channels[where] = writer.register_channel(where, encoding, schema)
            time = EPOCH * 10**9 + k * STEP
            writer.add_message(channels[where], time + 2000, data, time + 1000, k)
        writer.finish()


def mcap():
    plain = [(k, encode(state(k))) for k in range(ROWS)]
    unindexed = dict(index_types=IndexType.NONE, use_statistics=False, use_summary_offsets=False,
                     repeat_channels=False, repeat_schemas=False)
    write("zstd.mcap", plain, compression=CompressionType.ZSTD)
    write("lz4.mcap", plain, compression=CompressionType.LZ4)
    write("chunked.mcap", plain)
    write("unchunked.mcap", plain, use_chunking=False)
    write("unindexed.mcap", plain, compression=CompressionType.ZSTD, **unindexed)
    write("big_endian.mcap", [(k, big_endian(k)) for k in range(ROWS)], compression=CompressionType.ZSTD)
    whole = (HERE / "chunked.mcap").read_bytes()
    (HERE / "truncated.mcap").write_bytes(whole[: len(whole) * 3 // 5])
    flipped = bytearray(whole)
    # In the last message, so that the rows before it are one motion.
    flipped[whole.rindex(b"shoulder")] ^= 0xFF
    (HERE / "flipped.mcap").write_bytes(flipped)

    several = []
    for k in range(ROWS):
        several.append((k, encode(gripper(k))))
        if k % 3 == 0:
            # Two publishers of a joint each, of one stamp; the second one has a frame of another length.
            several.append((k, encode(state(k, joints=(1,), frame="a"))))
            several.append((k, encode(state(k, joints=(0,), velocity=False))))
        else:
            several.append((k, encode(state(k, joints=(1, 0) if k % 2 else (0, 1), velocity=k % 2 == 0))))
        if k % 5 == 0:
            several.append((k, encode(state(k, effort=False, frame=""))))
    write("several.mcap", several, compression=CompressionType.LZ4)

    write("no_effort.mcap", [(k, encode(state(k, effort=False))) for k in range(ROWS)], compression=CompressionType.ZSTD)
    write("two_topics.mcap", [(k, data, topic) for k, data in plain for topic in ("/arm/joint_states", "/joint_states")],
          compression=CompressionType.ZSTD)

    def unstamped(k):
        message = state(k)
        message["header"]["stamp"] = dict(sec=0, nanosec=0)
        return encode(message)

    write("unstamped.mcap", [(k, unstamped(k)) for k in range(ROWS)], compression=CompressionType.ZSTD)

    def dynamic(k):
        q, dq, u = row(k)
        values = [dict(interface_names=["effort", "position"], values=[u[j], q[j]]) for j in (1, 0)]
        return encode_dynamic(dict(header=header(k), joint_names=["shoulder", "elbow"], interface_values=values))

    write("dynamic.mcap", [(k, dynamic(k)) for k in range(ROWS)], topic="/dynamic_joint_states", kind=DYNAMIC_TYPE,
          text=DYNAMIC, compression=CompressionType.ZSTD)
    def controller(k):
        q, dq, u = row(k)
        point = lambda q, dq, u: dict(positions=q, velocities=dq, accelerations=[], effort=u,
                                      time_from_start=dict(sec=0, nanosec=0))
        # Joints change their places from message to message.
        order = (1, 0) if k % 2 else (0, 1)
        pick = lambda values: [values[j] for j in order]
        nothing = point([9.0] * 3, [], [])
        return encode_controller(dict(
            header=header(k, "base" + "x" * (k % 5)), joint_names=[("elbow", "shoulder")[j] for j in order], desired=nothing,
            actual=point(pick(q), pick(dq), pick(u)), error=nothing, multi_dof_joint_names="ab", flags=[1, 2, 3], load=k / 8))

    write("controller.mcap", [(k, controller(k)) for k in range(ROWS)], topic="/arm_controller/state", kind=CONTROLLER_TYPE,
          text=CONTROLLER, compression=CompressionType.ZSTD)
    write("json.mcap", [(0, b"{}")], topic="/chatter", kind="std_msgs/msg/String", text="string data", encoding="json")

    bag = HERE / "bag"
    shutil.rmtree(bag, ignore_errors=True)
    bag.mkdir()
    write("bag/bag_0.mcap", plain[: ROWS // 2], compression=CompressionType.ZSTD)
    write("bag/bag_1.mcap", plain[ROWS // 2 :], compression=CompressionType.ZSTD)
    (bag / "metadata.yaml").write_text(
        "rosbag2_bagfile_information:\n  version: 9\n  storage_identifier: mcap\n  duration:\n    nanoseconds: 390000000\n"
        "  message_count: 40\n  compression_format: ''\n  compression_mode: ''\n"
        "  relative_file_paths:\n    - bag_0.mcap\n    - bag_1.mcap\n"
    )


def parquet():
    rows = [row(k) for k in range(ROWS)]
    column = lambda channel, j: [values[channel][j] for values in rows]
    time = [k * 0.01 for k in range(ROWS)]
    names = ["t", "q1", "q2", "dq1", "dq2", "u1", "u2"]
    columns = [time] + [column(c, j) for c in range(3) for j in range(2)]
    table = pa.table([pa.array(values) for values in columns], names=names)
    for codec in ("snappy", "zstd", "lz4", "none", "gzip", "brotli"):
        pq.write_table(table, HERE / f"{codec}.parquet", compression=codec, row_group_size=16)
    pq.write_table(table, HERE / "pages_v2.parquet", compression="zstd", data_page_version="2.0", use_dictionary=False,
                   data_page_size=64, column_encoding={"t": "BYTE_STREAM_SPLIT"})
    nanoseconds = [EPOCH * 10**9 + k * STEP for k in range(ROWS)]
    other = table.set_column(0, "t", pa.array(nanoseconds, pa.timestamp("ns")))
    other = other.set_column(1, "q1", pa.array(columns[1], pa.float32()))
    torque = [None if k == 7 else float("nan") if k == 8 else x for k, x in enumerate(columns[5])]
    other = other.set_column(5, "u1", pa.array(torque)).append_column("task", pa.array(["lift"] * ROWS))
    pq.write_table(other, HERE / "types.parquet", compression="zstd")
    # Whole milliseconds without a unit, from an epoch.
    whole = [EPOCH * 1000 + k * 10 for k in range(ROWS)]
    pq.write_table(table.set_column(0, "t", pa.array(whole, pa.int64())), HERE / "whole.parquet", compression="snappy")
    states = [q + u for q, _, u in rows]
    lists = {
        "timestamp": pa.array(time, pa.float32()),
        "observation.state": pa.array(states, pa.list_(pa.float32())),
        "action": pa.FixedSizeListArray.from_arrays(pa.array([x for s in states for x in s]), 4),
        "frame_index": pa.array(range(ROWS), pa.int64()),
    }
    pq.write_table(pa.table(lists), HERE / "lists.parquet", compression="zstd")
    pq.write_table(pa.table(lists), HERE / "lists_snappy.parquet", compression="snappy", data_page_size=128)


mcap()
parquet()
