#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-3.0-or-later
# The units are understood by systemd, and the exposure of each is 1.0 or less. Usage: unit_file_test.sh SOURCE_DIR
set -euo pipefail
if ! command -v systemd-analyze >/dev/null; then
  echo "SKIPPED: systemd-analyze is not installed, so the unit file was NOT checked" >&2
  exit 77
fi
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# Complaints about a program that is not installed are not what is tested here.
for unit in mauve-guardian mauved; do
  sed 's#/usr/sbin/mauve[-a-z]*#/bin/true#' "$1/systemd/$unit.service" >"$work/$unit.service"
  complaints=$(systemd-analyze verify --man=no "$work/$unit.service" 2>&1)
  if [[ -n $complaints ]]; then
    echo "systemd-analyze verify: $complaints" >&2
    exit 1
  fi
  systemd-analyze security --offline=true --threshold=10 "$work/$unit.service" | tail -1
done

# The check of `systemctl reload` takes the file, and looks for plugins, as the start does.
for line in ExecStart ExecReload; do
  grep -q "^$line=.* \${MAUVED_FILE} .*\$MAUVED_OPTIONS\$" "$1/systemd/mauved.service" ||
    { echo "$line of mauved.service does not use MAUVED_FILE and MAUVED_OPTIONS" >&2; exit 1; }
done

# With the drop-ins in force (comment signs removed) it must still be understood.
for drop_in in capabilities devices; do
  mkdir -p "$work/mauved.service.d"
  sed -E 's/^#(\[|[A-Z][A-Za-z]+=)/\1/' "$1/systemd/mauved-$drop_in.conf" \
    >"$work/mauved.service.d/$drop_in.conf"
  complaints=$(systemd-analyze verify --man=no "$work/mauved.service" 2>&1)
  if [[ -n $complaints ]]; then
    echo "systemd-analyze verify with $drop_in.conf: $complaints" >&2
    exit 1
  fi
  rm -r "$work/mauved.service.d"
done

# Users and directories: parsed for real, below a root of their own.
mkdir -p "$work/root/etc"
if ! command -v systemd-sysusers >/dev/null; then
  echo "SKIPPED: systemd-sysusers is not installed, so the users were NOT checked; the units are understood" >&2
  exit 77
fi
systemd-sysusers --root="$work/root" "$1/systemd/mauved.sysusers" >"$work/out" 2>&1 ||
  { cat "$work/out" >&2; exit 1; }
grep -q '^mauve:' "$work/root/etc/passwd"
grep -q '^mauve-view:' "$work/root/etc/group"
grep -q '^mauve-admin:' "$work/root/etc/group"
echo "the units are understood"
