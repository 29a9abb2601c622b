"""Start-up, without a clock: which modules a command loads, and which it does not."""

import subprocess
import sys

import pytest

LIST = "import sys, atexit; atexit.register(lambda: print(*sys.modules, file=open(sys.argv[1], 'w')))\n"
RUN = LIST + "from pearlbvp.cli import main; main(sys.argv[2:])"
SCIPY = {"scipy.optimize", "scipy.spatial", "scipy.interpolate", "scipy.sparse.linalg"}

COMMANDS = {
    "dispersion --c0 0.48 --length 10": {"numba", "scipy", "h5py", "pearlbvp.continuation"},
    "amplitude --c0 0 --length 10 --mode 1,1": {"numba", "scipy", "h5py"},
    "localized --c0 0.48 --period 7.5 --lengths 15": {"scipy.linalg", "h5py", "pearlbvp.tube", "pearlbvp.mesh"},
    "branch pearl --c0 0.48 --length 7.5 --until v=1.001": SCIPY | {"pearlbvp.tube", "pearlbvp.mesh"},
    "branch ring --c0 -1 --length 10 --until v=0.95": SCIPY - {"scipy.sparse.linalg"} | {"pearlbvp.mesh"},
    "branch coil --c0 0 --length 10 --until v=0.999": SCIPY | {"pearlbvp.collocation", "pearlbvp.mesh"},
    "flow --c0 0.48 --length 7.5 --point v=1.001 --time 0.01": {"scipy.interpolate", "pearlbvp.mesh"},
}


@pytest.mark.parametrize("command", COMMANDS)
def test_a_command_loads_nothing_that_it_does_not_need(command, tmp_path):
    run = [sys.executable, "-c", RUN, str(tmp_path / "loaded"), *command.split()]
    done = subprocess.run(run, capture_output=True, text=True, check=False)
    if "compiling" in done.stderr:  # which loads all of numba, once
        done = subprocess.run(run, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    loaded = set((tmp_path / "loaded").read_text().split())
    assert "pandas" in loaded  # which all of them need for their table: the list is one
    assert loaded & (COMMANDS[command] | {"matplotlib"}) == set()
