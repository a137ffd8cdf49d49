"""Staya's dialect for pymavlink: `python dialect.py` makes it a part of the installed one.

The messages of controller/mavlink/messages/staya.xml, on top of the whole public dialects that pymavlink brings along.
"""

import shutil
import sys
from pathlib import Path

import pymavlink
from pymavlink.generator import mavgen

MESSAGES = Path(__file__).resolve().parents[2] / "controller/mavlink/messages/staya.xml"
DIALECTS = Path(pymavlink.__file__).parent / "dialects/v20"


def generate(language: str, folder: Path, name: str = "staya") -> Path:
    """Writes `name` for a language that mavgen knows (Python3, WLua, ...) into a folder and returns the file."""
    definition = DIALECTS / "staya.xml"
    shutil.copyfile(MESSAGES, definition)
    output = folder / name
    options = mavgen.Opts(str(output), wire_protocol="2.0", language=language, validate=False)
    if not mavgen.mavgen(options, [str(definition)]):
        sys.exit(f"mavgen could not make {output}")
    suffix = {"Python3": ".py", "WLua": ".lua"}.get(language, "")
    return output.with_suffix(suffix)


if __name__ == "__main__":
    print(generate("Python3", DIALECTS))
