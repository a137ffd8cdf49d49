"""The checks of `soak.py` can fail."""

import pytest
import soak


def of(*samples):
    """A process with given samples: bytes, threads, files, seconds of waiting."""
    process = object.__new__(soak.Process)
    process.name = "it"
    process.samples = [
        dict(s=float(second), bytes=size, threads=threads, files=files, waited_s=waited) for second, (size, threads, files, waited) in enumerate(samples)
    ]
    return process


def verdicts(judging):
    judge = soak.Judge()
    judging(judge)
    return {row["what"]: row["passed"] for row in judge.rows}


MIB = 1 << 20


@pytest.mark.parametrize(
    ["name", "samples", "is_flat", "are_same"],
    [
        ("flat", [(10 * MIB, 5, 5, 0.0)] * 20, True, True),
        ("grows at first", [(min(second, 10) * MIB, 5, 5, 0.0) for second in range(20)], True, True),
        ("grows on", [(10 * MIB + second * MIB // 4, 5, 5, 0.0) for second in range(20)], False, True),
        ("keeps a thread", [(MIB, 5, 5, 0.0)] * 19 + [(MIB, 6, 5, 0.0)], True, False),
        ("keeps a file", [(MIB, 5, 5, 0.0)] * 19 + [(MIB, 5, 6, 0.0)], True, False),
    ],
)
def test_memory_threads_and_files(name, samples, is_flat, are_same):
    assert list(verdicts(lambda judge: judge.memory(of(*samples))).values()) == [is_flat, are_same], name


@pytest.mark.parametrize(["missed", "waited_s", "is_right"], [(0, 0.0, True), (1, 0.0, False), (10, 0.5, True), (11, 0.5, False)])
def test_only_scheduling_delays_excuse_missed_deadlines(missed, waited_s, is_right):
    process = of((MIB, 1, 1, waited_s))
    assert list(verdicts(lambda judge: judge.deadlines(process, missed, 100, 0.05, 0.1)).values()) == [is_right]


@pytest.mark.parametrize(["lost", "is_right"], [(1, True), (0, False), (2, False)])
def test_a_wrong_frame_count_is_detected(lost, is_right):
    report = dict(lines=[dict(frames_in=10, lost_in=lost)], frames_heard=4, frames_ignored=3, frames_refused=2, frames_waiting=0)
    assert list(verdicts(lambda judge: soak.accounts(judge, "it", report)).values()) == [is_right]
