"""Tables by the ending of ``--out``: the same numbers in each, with units, meaning and what made them."""

import json
import re
from pathlib import Path

import pandas as pd
import pytest
from support.commands import run

from pearlbvp.cli import cli
from pearlbvp.columns import meaning
from pearlbvp.dimensions import QUANTITIES
from pearlbvp.units import Units

ROOT = Path(__file__).parents[2]
DISPERSION = ["dispersion", "--c0", "0.3", "--length", "12"]
PHYSICAL = ["dispersion", "--radius", "50nm", "--kappa", "20kT", "--c0", "1/(150nm)", "--length", "2um"]


def written(capsys, path, arguments):
    status, out, err = run(capsys, *arguments, "--out", path)
    assert (status, out, err) == (0, "", "")
    return path


@pytest.mark.parametrize("arguments", [DISPERSION, PHYSICAL])
def test_all_endings_have_the_same_table(arguments, capsys, tmp_path):
    status, printed, _ = run(capsys, *arguments)
    assert status == 0
    files = {ending: written(capsys, tmp_path / f"t{ending}", arguments) for ending in (".csv", ".parquet", ".json")}
    assert files[".csv"].read_text() == printed
    table = pd.read_csv(files[".csv"])
    assert len(table) > 10
    for other in (pd.read_parquet(files[".parquet"]), pd.read_json(files[".json"], orient="table")):
        pd.testing.assert_frame_equal(other.fillna(""), table.fillna(""), rtol=1e-11, check_dtype=False)


def columns_of(path):
    """Unit and meaning by column, of each kind of file."""
    if path.suffix == ".parquet":
        return pd.read_parquet(path).attrs["columns"]
    if path.suffix == ".json":
        fields = json.loads(path.read_text())["schema"]["fields"]
        return {f["name"]: {key: f[key] for key in ("unit", "meaning") if key in f} for f in fields}
    metadata = json.loads(path.with_name(f"{path.name}-metadata.json").read_text())
    assert metadata["url"] == path.name
    terms = {"schema:unitText": "unit", "dc:description": "meaning"}
    return {c["titles"]: {terms[key]: c[key] for key in c if key in terms} for c in metadata["tableSchema"]["columns"]}


@pytest.mark.parametrize("ending", [".csv", ".parquet", ".json"])
def test_files_say_what_columns_are(ending, capsys, tmp_path):
    plain = columns_of(written(capsys, tmp_path / f"a{ending}", DISPERSION))
    assert plain["lambda2"] == {"unit": "2kappa R^-3", "meaning": meaning("lambda2")}
    assert (plain["k"]["unit"], plain["m"]["unit"], "unit" in plain["role"]) == ("R^-1", "1", False)
    physical = columns_of(written(capsys, tmp_path / f"b{ending}", PHYSICAL))
    assert physical["lambda2[Pa]"] == {"unit": "Pa", "meaning": meaning("lambda2")}
    assert physical["k[1/nm]"]["unit"] == "1/nm"
    ours = columns_of(
        written(capsys, tmp_path / f"c{ending}", [*DISPERSION[:3], "--length", "0.6", "--radius", "0.05"])
    )
    assert ours["lambda1"]["unit"] == "2kappa U^-2"


def test_a_file_says_what_made_it(capsys, tmp_path):
    path = written(capsys, tmp_path / "t.csv", PHYSICAL)
    command = f"pearlbvp dispersion --radius 50nm --kappa 20kT --c0 '1/(150nm)' --length 2um --out {path}"
    assert json.loads((tmp_path / "t.csv-metadata.json").read_text())["dc:source"] == command


def test_standard_output_and_devices_have_nothing_beside_them(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert run(capsys, *DISPERSION, "--out", "-")[0] == 0
    assert run(capsys, *DISPERSION, "--out", "/dev/null")[0] == 0
    assert not list(tmp_path.iterdir())
    assert not Path("/dev/null-metadata.json").exists()


def test_powers_of_units_are_those_of_si():
    """A unit of lengths, energies and times, raised to the powers that the words say, is what ``Units`` converts by."""
    base = {"2kappa": 2 * 20 * 1.380649e-23 * 310, "R": 50e-9}
    si = {"lambda1": (1e-3, "2kappa R^-2"), "lambda2": (1.0, "2kappa R^-3"), "force": (1e-12, "2kappa R^-1")}
    for name, (unit, words) in si.items():
        assert QUANTITIES[name].powers("R") == words
        value = 1.0
        for word in words.split():
            factor, _, power = word.partition("^")
            value *= base[factor] ** int(power or 1)
        assert Units.of("50nm", "20kT").to_user(name, 1.0) == pytest.approx(value / unit, rel=1e-9)


def test_every_column_of_the_documentation_has_a_meaning():
    text = (ROOT / "docs/commands.md").read_text()
    rows = re.findall(r"^\| `.*?` \| (.*) \|$", text.partition("## Columns of every command")[2], re.MULTILINE)
    lists = [words for row in rows for words in re.findall(r"`([^`]*)`", row) if words not in cli.commands]
    names = {name for words in lists for name in words.split(",") if not name.startswith("--")}
    assert len(names) > 90
    assert {name for name in names if not meaning(name)} == set()
