#!/usr/bin/env bash
# Installs what is missing, checks the format, builds everything and runs every test.
source "$(dirname "$0")/common.sh"

"$root/scripts/setup.sh"

say "Checking the format"
find core maps localization sim scenarios render apps tests benchmarks -name '*.h' -o -name '*.cpp' |
  xargs clang-format --dry-run --Werror

build all

say "Running the tests"
as_user ctest --preset release -j "$(nproc)"
