"""MCAP files of `staya run --mcap`, read by the official Python package and by protobuf with the
schemas in the file."""

import csv
import json
import math
import os
import subprocess
from collections import Counter
from pathlib import Path

import jsonschema
import pytest
from google.protobuf import descriptor_pb2, descriptor_pool, message_factory
from mcap.exceptions import McapError
from mcap.reader import NonSeekingReader, make_reader

ROOT = Path(__file__).resolve().parents[2]
STAYA = os.environ.get("STAYA", ROOT / "target/debug/staya")

# Numbers and types of fields in Foxglove's .proto files, which the file must equal.
FOXGLOVE = {
    "SceneUpdate": {"deletions": 1, "entities": 2},
    "SceneEntity": {"timestamp": 1, "frame_id": 2, "id": 3, "lifetime": 4, "frame_locked": 5, "metadata": 6, "spheres": 9, "cylinders": 10, "lines": 11},
    "CylinderPrimitive": {"pose": 1, "size": 2, "bottom_scale": 3, "top_scale": 4, "color": 5},
    "SpherePrimitive": {"pose": 1, "size": 2, "color": 3},
    "LinePrimitive": {"type": 1, "pose": 2, "thickness": 3, "scale_invariant": 4, "points": 5, "color": 6, "colors": 7, "indices": 8},
    "PosesInFrame": {"timestamp": 1, "frame_id": 2, "poses": 3},
    "FrameTransform": {"timestamp": 1, "parent_frame_id": 2, "child_frame_id": 3, "translation": 4, "rotation": 5},
    "Grid": {"timestamp": 1, "frame_id": 2, "pose": 3, "column_count": 4, "cell_size": 5, "row_stride": 6, "cell_stride": 7, "fields": 8, "data": 9},
    "Log": {"timestamp": 1, "level": 2, "message": 3, "name": 4, "file": 5, "line": 6},
}


def run(tmp_path, scenario, *arguments):
    """Runs a scenario. Returns the MCAP file and the lines of trace.csv."""
    file, out = tmp_path / "run.mcap", tmp_path / "out"
    command = [STAYA, "run", ROOT / "scenarios" / scenario, "--quiet", "--out", out, "--mcap", file, *arguments]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL, timeout=120)
    with open(out / "trace.csv", newline="") as trace:
        return file, list(csv.DictReader(trace))


def nose(turn):
    """Direction of a body's x axis after its rotation, which must not change lengths or roll the
    body."""
    x, y, z, w = turn.x, turn.y, turn.z, turn.w
    assert x**2 + y**2 + z**2 + w**2 == pytest.approx(1.0)
    side = 2 * (y * z + x * w)
    assert side == pytest.approx(0.0, abs=1e-9)
    return [1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)]


def direction(velocity):
    """Normalised; east for a stationary body."""
    speed = math.hypot(*velocity)
    return [value / speed for value in velocity] if speed > 0 else [1.0, 0.0, 0.0]


def decoder(schema):
    """A decoder for the messages of a schema that uses only the file."""
    if schema.encoding == "jsonschema":
        validator = jsonschema.Draft202012Validator(json.loads(schema.data))

        def read(data):
            value = json.loads(data)
            validator.validate(value)
            return value

        return read
    assert schema.encoding == "protobuf"
    files = descriptor_pb2.FileDescriptorSet.FromString(schema.data)
    pool = descriptor_pool.DescriptorPool()
    for file in files.file:
        pool.Add(file)
    kind = message_factory.GetMessageClass(pool.FindMessageTypeByName(schema.name))

    def read(data):
        message = kind.FromString(data)
        assert message.IsInitialized()
        return message

    return read


def messages(reader, **options):
    """Topic, time in seconds and content of each message."""
    decoders = {}
    for schema, channel, message in reader.iter_messages(**options):
        if schema.id not in decoders:
            decoders[schema.id] = decoder(schema)
        yield channel.topic, message.log_time / 1e9, decoders[schema.id](message.data)


def read_all(file):
    with open(file, "rb") as stream:
        return list(messages(make_reader(stream, validate_crcs=True)))


def of_topic(found, topic):
    return [(time, message) for at, time, message in found if at == topic]


@pytest.mark.parametrize("scenario", ["six-robots.toml", "twenty-discs.toml", "mixed.toml", "downwash.toml"])
def test_messages_match_the_trace(tmp_path, scenario):
    file, trace = run(tmp_path, scenario, "--ticks", "60")
    found = read_all(file)
    ticks = sorted({int(line["tick"]) for line in trace})
    counts = Counter(topic for topic, _, _ in found)
    for topic in ["/bodies", "/poses", "/figures"]:
        assert counts[topic] == len(ticks), topic
    assert counts["/tf"] == counts["/obstacles"] == 1 and counts["/events"] >= 1
    [(_, frames)] = of_topic(found, "/tf")
    [frame] = frames.transforms
    assert (frame.parent_frame_id, frame.child_frame_id) == ("world", "map")
    origin = [frame.translation.x, frame.translation.y, frame.translation.z]
    by_tick = {}
    for line in trace:
        by_tick.setdefault(int(line["tick"]), []).append(line)
    moments = zip(of_topic(found, "/poses"), of_topic(found, "/figures"), of_topic(found, "/bodies"), ticks, strict=True)
    for (time, poses), (_, figures), (_, bodies), tick in moments:
        lines = by_tick[tick]
        assert time == pytest.approx(float(lines[0]["time_s"]), abs=1e-6)
        assert poses.timestamp.seconds + poses.timestamp.nanos / 1e9 == pytest.approx(time, abs=1e-9)
        assert figures["tick"] == tick
        assert figures["arrived"] <= len(lines)
        entity = next(entity for entity in bodies.entities if entity.id == "robots")
        shapes = entity.spheres or entity.cylinders
        assert len(shapes) == len(lines) and len(poses.poses) >= len(lines)
        for pose, shape, line in zip(poses.poses, shapes, lines):
            place = [pose.position.x, pose.position.y, pose.position.z]
            for value, start, axis in zip(place, origin, "xyz"):
                assert value + start == pytest.approx(float(line[f"{axis}_m"]), abs=1e-3)
            assert [shape.pose.position.x, shape.pose.position.y] == place[:2]
            assert nose(pose.orientation) == pytest.approx(direction([float(line[f"v{axis}_mps"]) for axis in "xyz"]), abs=1e-2)
    if scenario in ["six-robots.toml", "twenty-discs.toml"]:
        [(_, land)] = of_topic(found, "/land")
        assert len(land.data) % land.row_stride == 0 and land.column_count == land.row_stride
        assert [(field.name, field.type) for field in land.fields] == [("ticks", 1)]


def test_schemas_equal_foxgloves(tmp_path):
    file, _ = run(tmp_path, "figure-5.toml", "--ticks", "2")
    with open(file, "rb") as stream:
        schemas = make_reader(stream).get_summary().schemas.values()
    names = {schema.name for schema in schemas}
    expected = {"FrameTransforms", "Grid", "SceneUpdate", "PosesInFrame", "Log"}
    assert names == {f"foxglove.{name}" for name in expected} | {"staya.Figures"}
    data = next(schema.data for schema in schemas if schema.name == "foxglove.SceneUpdate")
    files = descriptor_pb2.FileDescriptorSet.FromString(data)
    types = {kind.name: kind for file in files.file for kind in file.message_type}
    for name, fields in FOXGLOVE.items():
        assert {field.name: field.number for field in types[name].field} == fields


def test_a_truncated_file_is_readable_up_to_its_end(tmp_path):
    file, _ = run(tmp_path, "twenty-discs.toml")
    whole = read_all(file)
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(file.read_bytes()[: file.stat().st_size * 2 // 3])
    found = []
    with open(cut, "rb") as stream, pytest.raises((McapError, EOFError)):
        # In file order: sorting would need the end of the file.
        for message in messages(NonSeekingReader(stream), log_time_order=False):
            found.append(message)
    assert len(whole) / 3 < len(found) < len(whole)
    assert [(topic, time) for topic, time, _ in found] == [(topic, time) for topic, time, _ in whole[: len(found)]]


def test_every_nth_moment_and_the_last_one_are_written(tmp_path):
    file, trace = run(tmp_path, "figure-5.toml", "--ticks", "25", "--record-every", "10")
    ticks = [figures["tick"] for _, figures in of_topic(read_all(file), "/figures")]
    last = int(trace[-1]["tick"])
    assert ticks == sorted({*range(0, last + 1, 10), last})
