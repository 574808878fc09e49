"""python -m laves is the program."""
import os
import sys

from ._library import program_path


def main():
    program = program_path()
    if program is None:
        sys.exit("laves: the package came without the program")
    os.execv(program, ["laves", *sys.argv[1:]])


if __name__ == "__main__":
    main()
