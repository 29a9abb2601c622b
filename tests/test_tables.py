"""Tables as other programs write them."""

import numpy as np
import pytest

from pearlbvp.errors import InputError
from pearlbvp.files import MOST_TEXT
from pearlbvp.studies.reference import read_reference
from pearlbvp.tables import read_table

EXPECTED = {"x": [0.0, 1.5, -3.0], "r": [1.0, 2.25, 1e-3]}
PLAIN = "x,r\n0,1\n1.5,2.25\n-3,1e-3\n"
SAME = {
    "plain": PLAIN,
    "windows": PLAIN.replace("\n", "\r\n"),
    "old macintosh": PLAIN.replace("\n", "\r"),
    "byte-order mark": "\ufeff" + PLAIN,
    "no last end of line": PLAIN.rstrip(),
    "spaces around": " x , r \n 0 , 1\n1.5 ,2.25 \n -3, 1e-3\n",
    "capital letters and spaces": PLAIN.replace("x,r", " X , R "),
    "capital letters beside the very names": "X,x,r,R\n7,0,1,8\n7,1.5,2.25,8\n7,-3,1e-3,8\n",
    "excel, german": "\ufeffsep=;\r\nX;R\r\n0;1\r\n1,5;2,25\r\n-3;0,001\r\n;\r\n;\r\n",
    "excel, tabs named": "sep=\t\r\nx\tr\r\n0\t1\r\n1,5\t2,25\r\n-3\t1E-03\r\n",
    "empty rows at the end": PLAIN + ",\n,\n",
    "quoted decimal commas": 'x,r\n"0","1"\n"1,5","2,25"\n"-3","0,001"\n',
    "quoted": '"x","r"\n"0","1"\n"1.5","2.25"\n"-3","1e-3"\n',
    "semicolons": PLAIN.replace(",", ";"),
    "decimal commas": "x;r\n0;1\n1,5;2,25\n-3;0,001\n",
    "tabs": PLAIN.replace(",", "\t"),
    "spaces": "x r\n0 1\n1.5   2.25\n  -3 1e-3\n",
    "comments": "# by somebody\n% at some time\n" + PLAIN.replace("\n1.5", "\n# half\n1.5") + "# end\n",
    "comments in lines": "x,r\n0,1 # first\n1.5,2.25\n-3,1e-3 # last\n",
    "empty lines": "\n" + PLAIN.replace("\n", "\n\n"),
    "no header": PLAIN.removeprefix("x,r\n"),
    "savetxt": "# x r\n0.0 1.0\n1.5 2.25\n-3.0 1e-3\n",
    "savetxt with more": "# r,x,other\n1,0,7\n2.25,1.5,7\n1e-3,-3,7\n",
    "other columns, of words": "name,r,x\na,1,0\nb,2.25,1.5\nc,1e-3,-3\n",
    "separators at the ends": "x,r,\n0,1,\n1.5,2.25,\n-3,1e-3,\n",
}


def read(tmp_path, content, columns=("x", "r"), unnamed=("x", "r")):
    path = tmp_path / "t.csv"
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return read_table("profile", path, columns, unnamed)


@pytest.mark.parametrize("how", SAME)
def test_one_table_in_many_hands(tmp_path, how):
    assert read(tmp_path, SAME[how]) == EXPECTED


@pytest.mark.parametrize("encoding", ["utf-16", "utf-8-sig", "latin-1"])
def test_texts_in_other_encodings(tmp_path, encoding):
    assert read(tmp_path, ("# Länge in µm\n" + PLAIN).encode(encoding)) == EXPECTED


@pytest.mark.parametrize("word", ["inf", "-inf", "nan", "NaN", "Infinity", "1e999"])
def test_numbers_to_compare_with_are_finite(tmp_path, word):
    """Where none is needed the entry may be empty."""
    path = tmp_path / "r.csv"
    path.write_text(f"c0,period,L,v\n0.48,7.5,15,{word}\n")
    with pytest.raises(
        InputError, match=rf"^compare: .*'{word}' in column v of row 2, which is not finite; give a number"
    ):
        read_reference(path)
    path.write_text("c0,period,L,v\n0.48,7.5,15,\n")
    assert read_reference(path).v.isna().all()
    for columns in (None, ("L", "v")):
        path.write_text("c0,period,L,v\n0.48,7.5,,\n")
        with pytest.raises(InputError, match="^compare: .* has an empty entry in column L; give a number there"):
            read_reference(path, columns)


def test_empty_entries_are_not_numbers(tmp_path):
    assert np.isnan(read(tmp_path, "x,r\n0,1\n1,\n")["r"][1])


@pytest.mark.parametrize(
    ("content", "said"),
    [
        ("", "holds no table"),
        ("\n# x,r\n\n", "holds no table"),
        ("x,r\n", "holds no table"),
        ("x,y\n0,1\n", "has no column r; its columns are x, y"),
        ("X,Y\n0,1\n", "has no column r; its columns are X, Y"),
        ("x,rr\n0,1\n", "has no column r"),
        ("X,r,X\n0,1,2\n", "the columns 'X' and 'X', either of which may be x; rename"),
        (
            "x,r\n0,0,1,0\n0,5,1,1\n",
            "2 columns but a row of 4: 0,0,1,0; write decimal points where commas are no separators",
        ),
        (b"PK\x03\x04\x14\0\x06\0", "is a workbook of a spreadsheet program, not CSV; save its table as CSV"),
        ("x,r,x\n0,1,2\n", "two columns 'x'"),
        ("x,r\n0,1,2\n", "2 columns but a row of 3"),
        ("x,r\n0\n", "2 columns but a row of 1"),
        ("x,r\n0,one\n", "'one', which is no number, in column r of row 2"),
        ("0,1,2\n1,2,3\n", "no line with the names"),
        (b"\x89HDF\r\n\x1a\n\0\0", "is no text"),
        (b"\0" * 100, "is no text"),
    ],
)
def test_what_is_no_table_of_numbers_is_named(tmp_path, content, said):
    with pytest.raises(InputError, match=rf"^profile: [^\n]*{said}[^\n]*$"):
        read(tmp_path, content)


def test_a_file_of_a_gigabyte_is_not_read(tmp_path):
    with (tmp_path / "large.csv").open("wb") as file:
        file.truncate(MOST_TEXT + 1)
    with pytest.raises(InputError, match="^profile: .*more than 6.71e"):
        read_table("profile", tmp_path / "large.csv")
