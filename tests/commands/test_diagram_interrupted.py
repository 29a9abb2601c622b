"""Ctrl-C while all branches of a tube are followed: those before are written."""

import io

import pandas as pd
import pytest
from support.commands import run

from pearlbvp.studies import diagram

ALL = ["diagram", "--c0", "0.48", "--length", "15", "--mode", "2,0", "--mode", "1,0", "--depth", "0", "--until", "v=1.005",
       "--processes", "1"]  # fmt: skip


@pytest.mark.parametrize("whole", [0, 1])
def test_branches_before_an_interruption_are_written(whole, capsys, monkeypatch):
    followed = []

    def follow(tube, family, mode, options, **how):
        followed.append(mode)
        if len(followed) > whole:
            raise KeyboardInterrupt
        return family_branch(tube, family, mode, options, **how)

    family_branch = diagram.family_branch
    monkeypatch.setattr(diagram, "family_branch", follow)
    status, out, err = run(capsys, *ALL)
    assert status == 130
    assert "interrupted" in err
    assert followed == [(2, 0), (1, 0)][: whole + 1]
    if whole:
        table = pd.read_csv(io.StringIO(out))
        assert set(table.branch.astype(str)) == {"2"}
        assert table.v.iloc[-1] == pytest.approx(1.005)
    else:
        assert out == ""
