"""Meta-World's own methods over other helpers: the package's code as it is, with a few names standing for `scalars.py`.

A function of Python is its code and the names that the code looks up. Here the code stays and the names change, in a subclass, so
that the package itself is untouched and nothing of a task is written twice.
"""

from types import FunctionType

from scalars import REPLACEMENTS

PACKAGE = "metaworld."
# How an environment comes to be is no matter of speed, and the package looks into itself there.
LEFT_ALONE = ("__init__", "__getstate__", "__setstate__")


def rebound(environment, **replaced):
    """A subclass of a task's environment whose methods know `scalars.REPLACEMENTS`; `replaced` are whole methods."""
    modules = {}
    members = {}
    for base in reversed(environment.__mro__):
        if base.__module__.startswith(PACKAGE):
            for name, value in vars(base).items():
                if name not in LEFT_ALONE:
                    members[name] = _member(name, value, modules)
    subclass = type(environment.__name__, (environment,), {**members, **replaced})
    for names in modules.values():
        # A task calls its static methods by the name of its class.
        if names.get(environment.__name__) is environment:
            names[environment.__name__] = subclass
    return subclass


def _member(name, value, modules):
    if isinstance(value, FunctionType):
        return _function(name, value, modules)
    if isinstance(value, property):
        return property(_function(name, value.fget, modules))
    if isinstance(value, staticmethod):
        return staticmethod(_function(name, value.__func__, modules))
    return value


def _function(name, function, modules):
    if function.__name__ != name:
        # Inside the package's decorator, which asks at every step whether the task is set.
        function = next(cell.cell_contents for cell in function.__closure__ if isinstance(cell.cell_contents, FunctionType))
    names = modules.setdefault(function.__module__, {})
    if not names:
        names.update(function.__globals__)
        names.update((known, value) for known, value in REPLACEMENTS.items() if known in names)
    copy = FunctionType(function.__code__, names, function.__name__, function.__defaults__, function.__closure__)
    copy.__kwdefaults__ = function.__kwdefaults__
    return copy
