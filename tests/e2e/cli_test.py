#!/usr/bin/env python3
"""The real program from the outside. Usage: cli_test.py PATH_TO_TERACELL [arguments of unittest]."""
import program

if __name__ == "__main__":
    program.main("cases_agree", "cases_assemblies", "cases_meshes", "cases_scenes", "cases_shapes", "cases_usage", "cases_inputs", "cases_open", "cases_parts", "cases_check", "cases_diff", "cases_boundary", "cases_faults", "cases_files", "cases_names", "cases_to_scale", "cases_wide", "cases_step", "cases_readme")
