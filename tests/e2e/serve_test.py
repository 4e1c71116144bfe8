#!/usr/bin/env python3
"""The real server from the outside. Usage: serve_test.py PATH_TO_TERACELL [arguments of unittest]."""
import program

if __name__ == "__main__":
    program.main("cases_serve", "cases_serve_files", "cases_serve_limits", "cases_nginx")
