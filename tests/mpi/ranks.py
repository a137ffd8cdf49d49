"""`staya run` and `staya-mpi run` on ranks of this machine."""

import json
import os
import subprocess
from pathlib import Path

STAYA = Path(os.environ["STAYA"])
MPIRUN = os.environ.get("MPIRUN", "mpirun")


def alone(*arguments):
    """The command for one process."""
    return [str(STAYA), "run", "--quiet", "--json", *map(str, arguments)]


def ranks(count, *arguments):
    """The command for a number of ranks."""
    options = ["--allow-run-as-root", "--oversubscribe", "--bind-to", "none", "-n", str(count)]
    return [MPIRUN, *options, str(STAYA.with_name("staya-mpi")), "run", "--quiet", "--json", *map(str, arguments)]


def environment():
    """Ranks talk through shared memory, and modules of OpenMPI that the packages leave out are not mentioned."""
    return {
        **os.environ,
        "OMPI_MCA_pml": "ob1",
        "OMPI_MCA_btl": "self,vader",
        "OMPI_MCA_btl_vader_single_copy_mechanism": "none",
        "OMPI_MCA_mca_base_component_show_load_errors": "0",
        "PMIX_MCA_pcompress_base_silence_warning": "1",
    }


def figures(command, names):
    """Figures that a run prints, by their names."""
    done = subprocess.run(command, capture_output=True, text=True, env=environment())
    assert done.returncode == 0, f"{command}: {done.stderr}"
    said = json.loads(done.stdout)
    return {name: found for name in names if (found := list(find(said, name)))}


def find(value, name):
    """All values of a name, however deep."""
    if isinstance(value, dict):
        if name in value:
            yield value[name]
        for inner in value.values():
            yield from find(inner, name)
    elif isinstance(value, list):
        for inner in value:
            yield from find(inner, name)
