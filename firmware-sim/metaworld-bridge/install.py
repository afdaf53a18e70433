"""Steps of setting up the environment that run in Python, each in a process that dies with its parent.

    install.py venv DIRECTORY        create the virtual environment (run by the system's Python)
    install.py pip REQUIREMENTS      install the locked packages (run by the environment's Python)
    install.py check                 import everything the worker needs and print the versions
"""

import os
import runpy
import subprocess
import sys

from parent import leave_with_parent


def main(step, *arguments):
    parent = os.dup(0)
    os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
    leave_with_parent(parent, whole_group=True)
    STEPS[step](*arguments)


def create(directory):
    import venv

    try:
        venv.EnvBuilder(with_pip=True, symlinks=True).create(directory)
    except subprocess.CalledProcessError as error:
        # ensurepip's words are in the exception, and its message leaves them out.
        sys.exit(f"{error}\n{(error.output or b'').decode(errors='replace')}")


def install(requirements):
    # Settings of the person that would put the packages anywhere else.
    for elsewhere in ["PIP_TARGET", "PIP_PREFIX", "PIP_ROOT"]:
        os.environ.pop(elsewhere, None)
    options = ["--no-user", "--require-hashes", "--only-binary", ":all:", "--no-input", "--progress-bar", "off", "--retries", "2"]
    sys.argv = ["pip", "install", "--disable-pip-version-check", *options, "-r", requirements]
    runpy.run_module("pip", run_name="__main__", alter_sys=True)


def check():
    from session import versions

    print(versions("fast"))


STEPS = {"venv": create, "pip": install, "check": check}

if __name__ == "__main__":
    main(*sys.argv[1:])
