#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Install the Debian packages that are missing, as root or with sudo; do nothing when none is.
set -euo pipefail
list="$(dirname "$0")/debian-packages.txt"

if ! command -v dpkg-query >/dev/null; then
  echo "set-up: this is no Debian or Ubuntu; install what $list names by your own package manager" >&2
  exit 2
fi

missing=()
while read -r package; do
  status=$(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null || true)
  # Ubuntu names some libraries with a t64 suffix since its 64-bit time change.
  t64=$(dpkg-query -W -f='${db:Status-Status}' "${package}t64" 2>/dev/null || true)
  [ "$status" = installed ] || [ "$t64" = installed ] || missing+=("$package")
done < <(sed 's/#.*//' "$list" | awk 'NF {print $1}')

if [ ${#missing[@]} -eq 0 ]; then
  echo "set-up: Debian packages are all there"
  exit 0
fi

echo "set-up: installing Debian packages: ${missing[*]}"
sudo=()
if [ "$(id -u)" -ne 0 ]; then
  if ! command -v sudo >/dev/null; then
    echo "set-up: neither root nor sudo; run as root: apt-get install ${missing[*]}" >&2
    exit 2
  fi
  sudo=(sudo)
fi
export DEBIAN_FRONTEND=noninteractive
"${sudo[@]}" apt-get update -qq
"${sudo[@]}" apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null
