"""The package's types, and its documentation."""

import doctest
import importlib
import inspect
import os
import pkgutil
import subprocess
import sys

import anamorph as am


def test_types_are_right():
    out = subprocess.run([sys.executable, "-m", "mypy", "--strict", "--cache-dir", os.devnull, "-p", "anamorph"], capture_output=True, text=True)
    assert out.returncode == 0, out.stdout + out.stderr


def test_examples_in_the_documentation_run():
    tried = 0
    for module in pkgutil.iter_modules(am.__path__, "anamorph."):
        if module.name not in ("anamorph.__main__", "anamorph._native"):
            result = doctest.testmod(importlib.import_module(module.name))
            assert result.failed == 0
            tried += result.attempted
    result = doctest.testmod(am)
    assert result.failed == 0 and result.attempted + tried >= 6


def test_everything_public_is_documented():
    for name in am.__all__:
        item = getattr(am, name)
        if inspect.isclass(item) or inspect.isfunction(item):
            assert inspect.getdoc(item), name
        if inspect.isclass(item):
            for member, value in vars(item).items():
                if not member.startswith("_") and callable(getattr(value, "fget", value)):
                    assert inspect.getdoc(value), f"{name}.{member}"
