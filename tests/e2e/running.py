"""The main program of the tests from the outside: all cases of some files, or those that unittest's arguments name."""
import importlib
import os
import sys
import types
import unittest


def run(*files):
    if len(sys.argv) < 2:
        sys.exit(f"usage: {os.path.basename(sys.argv[0])} PATH_TO_TERACELL [arguments of unittest]")
    os.environ["TERACELL"] = os.path.abspath(sys.argv.pop(1))  # before `program` is imported
    cases = types.ModuleType("cases")
    for file in files:
        vars(cases).update(vars(importlib.import_module(file)))
    unittest.main(cases)
