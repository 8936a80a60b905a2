#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Begin a session on a robot: a folder of its own under RUNS, its resolved configuration in it, RUNS/current to it.
#   deploy/new_session.sh [RUNS [CONFIG]]
set -eu
runs=${1:-/var/lib/kinemap}
config=${2:-/etc/kinemap/kinemap.toml}
session=$(date -u +%Y%m%d-%H%M%S)
folder=$runs/$session
mkdir -p "$folder"
if ! kinemap config dump --config "$config" --set "run.out=$folder" --set "run.session=$session" >"$folder/config.toml"; then
    rm -r "$folder"
    exit 2
fi
ln -sfn "$session" "$runs/current"
echo "$folder"
