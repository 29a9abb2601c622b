"""Arguments of the package in the words of the command line."""

import click

from pearlbvp.commands.command import as_typed, option_of

PARAMS = [
    click.Option(["--max-points"]),
    click.Option(["--max-step"]),
    click.Option(["--time", "until"]),
    click.Option(["--mode", "modes"]),
    click.Option(["--lengths"]),
    click.Argument(["family"]),
]


def test_arguments_are_options_by_their_first_word():
    for argument, typed in (
        ("max_points", "--max-points"),
        ("until v", "--time v"),
        ("mode", "--mode"),
        ("length", "--lengths"),
        ("--mode", "--mode"),
        ("family", "FAMILY"),
    ):
        assert option_of(argument, PARAMS) == typed


def test_underscored_names_in_sentences_are_options():
    for message, typed in (
        ("above max_step = 2", "above --max-step = 2"),
        ("max_points = 4 reached; ask for more", "--max-points = 4 reached; ask for more"),
        ("as it was typed, --max-step too", "as it was typed, --max-step too"),
        ("is no option, nor is r_max", "is no option, nor is r_max"),
    ):
        assert as_typed(message, PARAMS) == typed
