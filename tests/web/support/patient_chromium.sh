#!/bin/sh
# Chromium (MORTISE_CHROMIUM) behind what else runs on this machine. It is started in a session of its own, and Linux shares processors
# among sessions first (sched_autogroup): nice alone would leave it as much as all other tests together get, and a server that gets no
# processor for 0.15 s counts as gone.
echo 10 2>/dev/null >/proc/self/autogroup
exec nice -n 10 "${MORTISE_CHROMIUM:-/usr/bin/chromium}" "$@"
