#!/usr/bin/env bash
# Installs what is missing, builds, and drives a car for two minutes through a town, localizing it
# by LIDAR against a prior map. Ends with a table of scores and pictures in runs/demo.
source "$(dirname "$0")/common.sh"

"$root/scripts/setup.sh"
build locsim

say "Driving"
as_user "$build_dir/apps/locsim" run scenarios/library/first_drive.yaml --out runs/demo "$@"
