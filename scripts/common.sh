# Shared by the scripts beside it; sourced, not run.

set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
cd "$root"

say() { printf '\n== %s\n' "$*"; }
die() {
  printf 'error: %s\n' "$*" >&2
  exit 2
}

# Installing needs root; whoever is not root goes through sudo.
as_root() {
  if [ "$(id -u)" -eq 0 ]; then
    "$@"
  elif command -v sudo >/dev/null 2>&1; then
    sudo "$@"
  else
    die "installing packages needs root: run this script as root or install sudo"
  fi
}

# Building does not: a script called through sudo builds as the user who called it, so that the
# build folder stays theirs.
as_user() {
  if [ "$(id -u)" -eq 0 ] && [ -n "${SUDO_USER:-}" ] && [ "$SUDO_USER" != root ] &&
    command -v runuser >/dev/null 2>&1; then
    runuser -u "$SUDO_USER" -- "$@"
  else
    "$@"
  fi
}

build_dir="$root/build/release"

# build TARGETS…: configures where that has not been done, then builds.
build() {
  if [ ! -f "$build_dir/build.ninja" ]; then
    say "Configuring"
    as_user cmake --preset release
  fi
  say "Building $*"
  as_user cmake --build --preset release --target "$@"
}
