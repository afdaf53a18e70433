"""Steps of setting up the environment that run in Python, each in a process that dies with its parent.

    install.py venv DIRECTORY        create the virtual environment (run by the system's Python)
    install.py pip REQUIREMENTS      install the locked packages (run by the environment's Python)
    install.py check                 import everything the worker needs and print the versions
"""

import os
import runpy
import sys

from parent import leave_with_parent


def main(step, *arguments):
    parent = os.dup(0)
    os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
    leave_with_parent(parent, whole_group=True)
    STEPS[step](*arguments)


def create(directory):
    import venv

    venv.EnvBuilder(with_pip=True, symlinks=True).create(directory)


def install(requirements):
    options = ["--require-hashes", "--only-binary", ":all:", "--no-input", "--progress-bar", "off", "--retries", "2"]
    sys.argv = ["pip", "install", "--disable-pip-version-check", *options, "-r", requirements]
    runpy.run_module("pip", run_name="__main__", alter_sys=True)


def check():
    from session import versions

    print(versions())


STEPS = {"venv": create, "pip": install, "check": check}

if __name__ == "__main__":
    main(*sys.argv[1:])
