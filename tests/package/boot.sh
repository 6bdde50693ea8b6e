#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-3.0-or-later
# Process 1 of a machine that is a copy of this one: the root file system, with all that the test changes in it in
# memory. machine.py starts it in new namespaces: boot.sh WORK INIT... makes the machine in the empty folder WORK, with
# the folder WORK.copy as /opt/mauve-test, and becomes INIT.
set -euo pipefail
work=$1
shift
mount --make-rprivate /
mount -t tmpfs -o mode=755 machine "$work"
mkdir "$work"/{changed,overlay,root}
mount -t overlay -o "lowerdir=/,upperdir=$work/changed,workdir=$work/overlay" machine "$work/root"
cd "$work/root"
mount -t proc proc proc
mount -t sysfs -o ro sysfs sys
mount -t cgroup2 cgroup2 sys/fs/cgroup 2>/dev/null || echo "boot: no control groups, so no systemd" >&2
mount -t tmpfs -o mode=755 run run
mount -t tmpfs tmp tmp
mount -t tmpfs -o mode=755 dev dev
mkdir dev/{pts,shm}
for node in null zero full random urandom tty; do
  touch "dev/$node"
  mount --bind "/dev/$node" "dev/$node"
done
mount -t devpts -o newinstance,ptmxmode=0666 devpts dev/pts
mount -t tmpfs -o mode=1777 shm dev/shm
ln -s pts/ptmx dev/ptmx
ln -s /proc/self/fd dev/fd
mkdir -p opt/mauve-test
cp -r "$work.copy/." opt/mauve-test
# Services of the machine itself stay out, and dpkg may start ours.
rm -f usr/sbin/policy-rc.d
cat >etc/systemd/system/machine.target <<'END'
[Unit]
Requires=systemd-journald.service dbus.socket
After=systemd-journald.service dbus.socket
AllowIsolate=yes
END
mkdir old
pivot_root . old
# What the test changed is looked at in the end.
mkdir /run/changed
mount --bind "/old$work/changed" /run/changed
umount -l /old
export container=mauve-test PATH=/usr/sbin:/usr/bin:/sbin:/bin
exec "$@"
