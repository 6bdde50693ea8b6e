#!/bin/sh
# SPDX-License-Identifier: LGPL-3.0-or-later
# check_plugin.sh FILE.so: what mauve_add_plugin() promises about the file.
set -u
file=$1
failed=0
expect() { # WHAT EXPECTED ACTUAL
  if [ "$2" = "$3" ]; then echo "ok   $1"; else
    echo "FAIL $1: expected '$2', got '$3'"
    failed=1
  fi
}
expect "the only exported symbol" "mauve_plugin" \
  "$(nm -D --defined-only "$file" | awk '{print $3}' | tr '\n' ' ' | sed 's/ $//')"
expect "no symbol that forbids unloading" "0" "$(nm "$file" | awk '$2 == "u"' | wc -l)"
expect "no search path" "0" "$(readelf -d "$file" | grep -c -E 'RPATH|RUNPATH')"
expect "everything is bound at load" "1" "$(readelf -d "$file" | grep -c 'FLAGS_1.*NOW')"
expect "no executable stack" "RW" "$(readelf -lW "$file" | awk '/GNU_STACK/ {print $(NF-1)}')"
expect "a manifest to read before the code runs" "1" "$(readelf -SW "$file" | grep -c '\.mauve\.manifest')"
expect "the manifest holds the version" "1" "$(strings -a "$file" | grep -c -x '2\.3\.4')"
expect "nothing but mauve and the system is needed" "0" "$(readelf -d "$file" | awk '/NEEDED/ {print $NF}' |
  grep -c -v -E '^\[(libmauve|libstdc\+\+|libgcc_s|libm|libc|ld-linux-x86-64)\.so')"
exit $failed
