#!/usr/bin/env bash
# Runs clang-tidy (.clang-tidy) over every source, or over the files named. Slow: minutes.
source "$(dirname "$0")/common.sh"

"$root/scripts/setup.sh" --lint
[ -f "$build_dir/build.ninja" ] || as_user cmake --preset release
files=("$@")
if [ ${#files[@]} -eq 0 ]; then
  mapfile -t files < <(find core maps localization sim scenarios render apps -name '*.cpp' | sort)
fi
say "Linting ${#files[@]} files"
printf '%s\n' "${files[@]}" | as_user xargs -P "$(nproc)" -n 1 clang-tidy --quiet -p "$build_dir"
