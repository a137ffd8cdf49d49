"""Preconditions of all tests here: the program starts, and the dialect is installed."""


def test_the_program_prints_its_version(staya):
    process = staya("--version")
    assert process.wait() == 0
    assert process.output().startswith("staya ")


def test_an_error_names_the_invalid_argument(staya):
    process = staya("--no-such-option")
    assert process.wait() == 2
    assert "--no-such-option" in process.output()


def test_dialect_has_own_and_public_messages(dialect):
    assert dialect.MAVLink_staya_beacon_message.id == 9500000
    assert dialect.MAVLink_heartbeat_message.id == 0
