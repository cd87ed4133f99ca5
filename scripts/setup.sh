#!/usr/bin/env bash
# Installs from Debian 12 whatever is missing of the packages that building, testing and running
# need. With --lint also clang-tidy. Asks nothing; does nothing where all is there.
source "$(dirname "$0")/common.sh"

packages=(
  # tools
  g++ cmake ninja-build ccache pkg-config clang-format
  # libraries
  libeigen3-dev libtbb-dev libgeographiclib-dev librandom123-dev libembree-dev libbullet-dev
  libassimp-dev libpcl-dev libyaml-cpp-dev nlohmann-json3-dev libcli11-dev
  libosmesa6-dev libpng-dev libfreetype-dev fonts-dejavu-core
  # tests and benchmarks
  libgtest-dev libgmock-dev libbenchmark-dev rtklib
)
for argument in "$@"; do
  case "$argument" in
    --lint) packages+=(clang-tidy) ;;
    *) die "setup.sh: unknown argument '$argument'; there is --lint" ;;
  esac
done

command -v apt-get >/dev/null 2>&1 || die "apt-get not found: this script is for Debian 12; \
elsewhere install by hand: ${packages[*]}"

missing=()
for package in "${packages[@]}"; do
  state=$(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null || true)
  [ "$state" = installed ] || missing+=("$package")
done
[ ${#missing[@]} -eq 0 ] && exit 0

say "Installing ${#missing[@]} packages: ${missing[*]}"
export DEBIAN_FRONTEND=noninteractive
as_root apt-get update -qq
as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends "${missing[@]}"
