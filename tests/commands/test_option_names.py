"""Arguments of the package in the words of the command line."""

import click

from pearlbvp.commands.command import as_typed

PARAMS = [
    click.Option(["--max-points"]),
    click.Option(["--max-step"]),
    click.Option(["--time", "until"]),
    click.Option(["--mode", "modes"]),
    click.Option(["--lengths"]),
    click.Argument(["family"]),
]


def test_the_first_word_and_underscored_names_are_options():
    for message, typed in (
        ("max_points: 1 must be 2 or more", "--max-points: 1 must be 2 or more"),
        ("until v: 'x' is not a number", "--time v: 'x' is not a number"),
        ("mode: none", "--mode: none"),
        ("length: 0 must be positive", "--lengths: 0 must be positive"),
        ("step: above max_step = 2", "step: above --max-step = 2"),
        ("max_points = 4 reached; ask for more", "--max-points = 4 reached; ask for more"),
        ("--mode: as it was typed, --max-step too", "--mode: as it was typed, --max-step too"),
        ("family: is no option, nor is r_max", "family: is no option, nor is r_max"),
    ):
        assert as_typed(message, PARAMS) == typed
