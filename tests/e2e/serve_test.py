#!/usr/bin/env python3
"""The real server from the outside. Usage: serve_test.py PATH_TO_TERACELL [arguments of unittest]."""
import os
import sys
import unittest

if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit("usage: serve_test.py PATH_TO_TERACELL [arguments of unittest]")
    os.environ["TERACELL"] = os.path.abspath(sys.argv.pop(1))  # before `program` is imported
    sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
    from cases_serve import *  # noqa: F401,F403
    from cases_serve_limits import *  # noqa: F401,F403
    from cases_nginx import *  # noqa: F401,F403

    unittest.main()
