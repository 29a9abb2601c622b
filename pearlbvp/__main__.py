"""``python -m pearlbvp``: the command line."""

from pearlbvp.cli import main

if __name__ == "__main__":
    main()
