#!/usr/bin/env python3
"""Grids behind addresses. Usage: remote_test.py PATH_TO_TERACELL [arguments of unittest]."""
import program

if __name__ == "__main__":
    program.main("cases_remote", "cases_remote_serve")
