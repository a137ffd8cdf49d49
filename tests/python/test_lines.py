"""Preconditions of all tests here: the program starts, and the dialect is installed."""


def test_program_says_what_it_is(staya):
    process = staya("--version")
    assert process.wait() == 0
    assert process.output().startswith("staya ")


def test_bad_arguments_end_with_an_error_that_names_them(staya):
    process = staya("--no-such-option")
    assert process.wait() == 2
    assert "--no-such-option" in process.output()


def test_dialect_has_own_and_public_messages(dialect):
    assert dialect.MAVLink_staya_beacon_message.id == 9500000
    assert dialect.MAVLink_heartbeat_message.id == 0
