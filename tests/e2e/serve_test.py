#!/usr/bin/env python3
"""The real server from the outside. Usage: serve_test.py PATH_TO_TERACELL [arguments of unittest]."""
from running import run

run("cases_serve", "cases_serve_limits", "cases_nginx")
