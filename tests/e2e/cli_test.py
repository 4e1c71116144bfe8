#!/usr/bin/env python3
"""The real program from the outside. Usage: cli_test.py PATH_TO_TERACELL [arguments of unittest]."""
import os
import sys
import unittest

if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit("usage: cli_test.py PATH_TO_TERACELL [arguments of unittest]")
    os.environ["TERACELL"] = os.path.abspath(sys.argv.pop(1))  # before `program` is imported
    sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
    from cases_agree import *  # noqa: F401,F403
    from cases_meshes import *  # noqa: F401,F403
    from cases_scenes import *  # noqa: F401,F403
    from cases_shapes import *  # noqa: F401,F403
    from cases_usage import *  # noqa: F401,F403
    from cases_inputs import *  # noqa: F401,F403
    from cases_open import *  # noqa: F401,F403
    from cases_faults import *  # noqa: F401,F403
    from cases_files import *  # noqa: F401,F403

    unittest.main()
