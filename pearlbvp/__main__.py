"""``pearlbvp`` and ``python -m pearlbvp``: the command line."""

import signal

if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
    signal.signal(signal.SIGINT, signal.SIG_DFL)  # while all is imported an interruption ends it without a trace

from pearlbvp.cli import main

if __name__ == "__main__":
    main()
