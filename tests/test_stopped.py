"""The page on why a branch or a flow stops names every status that there is, and none that there is not."""

import re
from pathlib import Path
from typing import get_args

from pearlbvp.continuation.branch import Status as BranchStatus
from pearlbvp.flows.record import Status as FlowStatus
from pearlbvp.studies.stability_loss import Ending

PAGE = (Path(__file__).parents[1] / "docs" / "stopped.md").read_text()


def statuses(section):
    """The first column of the first table of a section."""
    table = PAGE.partition(f"## {section}")[2].partition("|---|")[2].split("\n\n")[0]
    return {name for row in table.splitlines()[1:] for name in re.findall(r"`(\w+)`", row.split("|")[1])}


def test_every_end_of_a_branch():
    assert statuses("Branches") == {status.value for status in BranchStatus}


def test_every_end_of_a_flow():
    assert statuses("Flows") == set(get_args(FlowStatus))


def test_every_status_of_the_localized_pearl():
    named = set(re.findall(r"`(\w+)`", PAGE.partition("## Tables")[2]))
    assert {ending.value[0] for ending in Ending} <= named
