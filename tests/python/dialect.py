"""Installs Staya's dialect into pymavlink: `python dialect.py`.

Adds the messages of controller/mavlink/messages/staya.xml to the complete public dialects of
pymavlink.
"""

import shutil
import sys
from pathlib import Path

import pymavlink
from pymavlink.generator import mavgen

MESSAGES = Path(__file__).resolve().parents[2] / "controller/mavlink/messages/staya.xml"
DIALECTS = Path(pymavlink.__file__).parent / "dialects/v20"


def generate(language: str, folder: Path, name: str = "staya") -> Path:
    """Generates `name` for a language of mavgen (Python3, WLua, ...) in a folder. Returns the path."""
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
